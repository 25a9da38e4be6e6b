//! A model of piles as a card has it: constants, and what is worked on together.

use crate::card::NUMBER;
use crate::constants::{Parameters, SHAPE};
use crate::joints::Joints;
use crate::meshes::Meshes;
use crate::plan::{GROUPS, Plan};
use crate::steps::{CONTACTS, PAIRS};
use crate::{Card, Need, PilesError};
use collide::{Route, kind};
use model::{CollisionFilter, Model, ShapeId};
use numbers::trace::Program;
use records::PilePrograms;
use rigid::impulse::pair::{PairPlaces, PairTables};
use rigid::impulse::{Collider, FARTHEST, Impulse, WORLD, row};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::sync::Arc;

/// What all worlds of a model have in common.
#[derive(Debug)]
pub(crate) struct Scene {
    pub impulse: Arc<Impulse>,
    pub programs: PilePrograms,
    pub joints: Option<Joints>,
    meshes: Meshes,
    pub parameters: Parameters,
    pub groups: Vec<Group>,
    /// What all worlds have in common.
    pub constants: Vec<f32>,
    pub whole: Vec<u32>,
    /// Shapes of pairs that have a surface of their own, and a shape of each surface.
    pub paired: HashSet<ShapeId>,
    pub surfaces: Vec<u32>,
    /// Whether there may be blows.
    pub bounces: bool,
    /// With the places of constants, and not yet those of what steps need.
    pub plan: Plan,
}

/// Pairs that one kernel meets.
#[derive(Debug)]
pub(crate) struct Group {
    pub tables: PairTables,
    /// For how many triangles of A and of B a pair has room; 0 for what is not met as a mesh.
    pub triangles: [usize; 2],
    pub program: Program,
    /// What tells sooner which of them are apart, where that is worth its while.
    pub apart: Option<Program>,
}

/// Kind and number of corners.
pub(crate) type Form = (usize, usize);

/// Others that a unit of work looks at for a large shape.
pub(crate) const UNIT: usize = 64;
/// Words of what a shape brings to the decision which may touch.
pub(crate) const SIDE: usize = 5;
/// No first of these: the unit is a small shape.
const SMALL: u32 = u32::MAX;
/// Numbers of a body while a step runs: behind its row, what it has of free velocity before blows.
pub(crate) const ROW: usize = row::WIDTH + 6;
/// Shapes of all worlds of a batch, at most: contacts name theirs by numbers that stand for whole ones up to there.
const NAMES: u32 = 1 << f32::MANTISSA_DIGITS;

impl Group {
    /// Whether anything is met as a mesh.
    pub fn has_mesh(&self) -> bool {
        self.triangles[1] > 0
    }
}

impl Scene {
    /// With so many worlds to be stepped, as many of them together as a card has room for.
    ///
    /// # Errors
    /// The model has what cards do not know of piles; one world is larger than a buffer of the card.
    pub fn new(
        card: &impl Card,
        impulse: &Impulse,
        model: &Model,
        filter: Option<&CollisionFilter>,
        worlds: usize,
    ) -> Result<Self, PilesError> {
        let parameters: Vec<_> = impulse.parameters().iter().map(|x| *x as f32).collect();
        let forms: BTreeSet<_> = impulse.shapes().iter().map(form_of).collect();
        let forms = Vec::from_iter(forms);
        let mut scene = Self {
            impulse: Arc::new(impulse.clone()),
            programs: PilePrograms::record()?,
            joints: Joints::new(impulse)?,
            meshes: Meshes::new(impulse, model),
            groups: Vec::new(),
            constants: Vec::new(),
            whole: Vec::new(),
            paired: HashSet::new(),
            surfaces: Vec::new(),
            bounces: false,
            plan: Plan::default(),
            parameters: Parameters::of_all(parameters.clone()),
        };
        let settings = impulse.settings();
        scene.plan.own_bodies = impulse.rows() as u32 - 1;
        scene.plan.own_shapes = impulse.shapes().len() as u32;
        scene.plan.remembered = impulse.capacity() as u32;
        scene.plan.state_numbers = impulse.lengths().state as u32;
        scene.plan.body_state = impulse.body_state(0) as u32;
        let places = impulse.memory_places().map(|n| n as u32);
        [scene.plan.count, scene.plan.forgotten, scene.plan.memory] = places;
        scene.plan.small_steps = settings.contact_iterations as u32;
        scene.plan.fastest = (settings.speed_limit as f32).next_down();
        scene.plan.farthest = FARTHEST as f32;
        scene.groups_of(&forms, &parameters, filter)?;
        let large = scene.large(&parameters);
        scene.shapes(&forms, &large);
        scene.mesh();
        scene.sides(filter);
        scene.paired(model);
        scene.units(&large);
        scene.surfaces()?;
        scene.tie();
        scene.place_constants();
        scene.spread(card, worlds)?;
        Ok(scene)
    }

    /// Places worlds side by side, as many as a card has room for.
    fn spread(&mut self, card: &impl Card, worlds: usize) -> Result<(), PilesError> {
        let alone = self.plan.of_worlds(1);
        let joints = self.joints.as_ref().map_or(0, Joints::widest);
        let numbers = [
            alone.numbers(),
            ROW as u32 * alone.bodies,
            SHAPE as u32 * alone.shapes,
            joints as u32 * alone.joints,
        ];
        let things = [
            PAIRS * alone.shapes,
            CONTACTS * alone.bodies,
            alone.most_invocations(),
        ];
        let longest = numbers.into_iter().max().unwrap_or(0).max(1);
        let things = card.most_invocations() / things.into_iter().max().unwrap_or(0).max(1);
        let named = NAMES / alone.shapes.max(1);
        let bytes = u64::from(longest) * NUMBER;
        Need::World.check(bytes, card.most_bytes(), card.name())?;
        let numbers = (card.most_bytes() / NUMBER).min(u32::MAX.into()) / u64::from(longest);
        let most = numbers.min(things.min(named).max(1).into()) as usize;
        let width = worlds.div_ceil(worlds.div_ceil(most));
        self.plan = self.plan.of_worlds(width as u32);
        Ok(())
    }
    /// Numbers of a pair in parameters and scratch: of two solids, or of a solid and a mesh.
    pub fn pair_lengths(&self, of_mesh: bool) -> [usize; 2] {
        let groups = self.groups.iter();
        let groups = groups.filter(|group| group.has_mesh() == of_mesh);
        let lengths = groups.map(|group| group.tables.lengths());
        lengths.fold([1; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])])
    }
    /// Pairs whose numbers fit into a buffer of a card.
    pub fn most_pairs(&self, card: &impl Card, of_mesh: bool) -> u32 {
        let [parameters, scratch] = self.pair_lengths(of_mesh);
        let bytes = parameters.max(scratch) as u64 * NUMBER;
        u32::try_from(card.most_bytes() / bytes).unwrap_or(u32::MAX)
    }

    /// Adds constants that all worlds have in common; where they begin.
    fn common(&mut self, numbers: impl IntoIterator<Item = f32>) -> u32 {
        let at = self.constants.len() as u32;
        self.constants.extend(numbers);
        at
    }
    /// Adds whole numbers; where they begin.
    fn whole(&mut self, numbers: impl IntoIterator<Item = u32>) -> u32 {
        let at = self.whole.len() as u32;
        self.whole.extend(numbers);
        at
    }

    /// A group for each two forms that a kernel meets, those with meshes last.
    fn groups_of(
        &mut self,
        forms: &[Form],
        parameters: &[f32],
        filter: Option<&CollisionFilter>,
    ) -> Result<(), PilesError> {
        let mut table = vec![u32::MAX; forms.len() * forms.len()];
        let impulse = Arc::clone(&self.impulse);
        let mut places = Vec::new();
        for of_mesh in [false, true] {
            for (i, a) in forms.iter().enumerate() {
                for (j, b) in forms.iter().enumerate().skip(i) {
                    let with_mesh = |r: &Route| matches!(r, Route::Mesh | Route::Meshes);
                    let route = Route::of(a.0, b.0);
                    let Some(route) = route.filter(|r| with_mesh(r) == of_mesh) else {
                        continue;
                    };
                    // Often there is but one mesh, which nothing else is.
                    if route == Route::Meshes && !meet(&impulse, filter, [*a, *b]) {
                        continue;
                    }
                    table[i * forms.len() + j] = self.groups.len() as u32;
                    let room = |of: Form, near| self.meshes.room(&impulse, parameters, near, of);
                    let (triangles, sizes) = match route {
                        Route::Mesh => ([0, room(*b, *a)], [a.1, room(*b, *a)]),
                        Route::Meshes => {
                            let rooms = [room(*a, *b), room(*b, *a)];
                            (rooms, rooms)
                        }
                        _ => ([0; 2], [a.1, b.1]),
                    };
                    let tables = PairTables::new(route, [a.0, b.0], sizes);
                    places.extend(words_of(&tables, triangles));
                    let sooner = tables.takes_long();
                    let apart = sooner.then(|| PilePrograms::apart(&tables));
                    self.groups.push(Group {
                        program: PilePrograms::pair(&tables)?,
                        apart: apart.transpose()?,
                        tables,
                        triangles,
                    });
                }
            }
            if !of_mesh {
                self.plan.solid_groups = self.groups.len() as u32;
            }
        }
        if self.groups.len() > GROUPS as usize {
            return Err(unsupported(
                "shapes of so many kinds and numbers of corners",
                "use fewer kinds, or run on the processor",
            ));
        }
        self.plan.forms = forms.len() as u32;
        self.plan.groups = self.groups.len() as u32;
        self.plan.form_group = self.whole(table);
        self.plan.group_places = self.whole(places);
        Ok(())
    }

    /// Which shapes are too large for cells: planes, and what is larger than most of what moves.
    fn large(&mut self, parameters: &[f32]) -> Vec<bool> {
        let impulse = &self.impulse;
        let shapes = impulse.shapes().iter().enumerate();
        let radius = |i: usize| impulse.radius_of(i, parameters);
        let moving = shapes.clone().filter(|(_, s)| s.row != WORLD);
        let mut radii: Vec<_> = moving.map(|(i, _)| radius(i)).collect();
        radii.sort_by(f32::total_cmp);
        let usual = radii.get(radii.len() * 9 / 10).copied().unwrap_or(1.0);
        self.plan.cell = 2.0 * usual.max(1e-6);
        let cell = self.plan.cell;
        shapes
            .map(|(i, s)| s.kind == kind::PLANE || radius(i) > cell)
            .collect()
    }

    fn shapes(&mut self, forms: &[Form], large: &[bool]) {
        let impulse = Arc::clone(&self.impulse);
        let shapes = impulse.shapes();
        let all = 0..shapes.len();
        self.plan.carriers = self.whole(shapes.iter().map(|s| s.row));
        let form = |i: usize| {
            let form = forms.partition_point(|f| *f < form_of(&shapes[i]));
            let [plane, mesh] = [kind::PLANE, kind::MESH].map(|kind| shapes[i].kind == kind);
            let flags = [plane, shapes[i].sensor, mesh].map(u32::from);
            [form as u32, flags[0] | flags[1] << 1 | flags[2] << 2]
        };
        self.plan.shape_form = self.whole(all.clone().flat_map(form));
        let mut corners = 0;
        let mut first = Vec::new();
        for (shape, large) in shapes.iter().zip(large) {
            first.extend([corners as u32, u32::from(*large)]);
            corners += 3 * shape.corners;
        }
        self.plan.first_corner = self.whole(first);
    }

    /// The triangles of all meshes, in groups of clusters.
    fn mesh(&mut self) {
        let Meshes { data, groups, .. } = std::mem::take(&mut self.meshes);
        let single = |numbers: Vec<f64>| numbers.into_iter().map(|x| x as f32);
        let ranges = |ranges: Vec<[usize; 2]>| ranges.into_iter().flatten().map(|i| i as u32);
        let (boxes, rows): (Vec<_>, Vec<_>) = data.groups().unzip();
        self.plan.mesh_groups = self.common(single(boxes.concat()));
        self.plan.mesh_group_rows = self.whole(ranges(rows));
        let (boxes, rows): (Vec<_>, Vec<_>) = data.clusters().unzip();
        self.plan.mesh_clusters = self.common(single(boxes.concat()));
        self.plan.mesh_cluster_rows = self.whole(ranges(rows));
        let triangles = data.triangles().iter();
        let triangles = triangles.flat_map(|t| t.numbers().map(|x| x as f32));
        self.plan.mesh_triangles = self.common(triangles.collect::<Vec<_>>());
        self.plan.mesh_of_shape = self.whole(ranges(groups));
    }

    /// Of each shape, those later ones that it touches in any case.
    fn paired(&mut self, model: &Model) {
        let shapes = self.impulse.shapes();
        let numbers: HashMap<_, _> = shapes.iter().map(|s| s.shape).zip(0..).collect();
        let number = |id: ShapeId| numbers.get(&id).copied();
        let mut others = vec![Vec::new(); shapes.len()];
        for pair in &model.contact_pairs {
            if let (Some(a), Some(b)) = (number(pair.shapes.0), number(pair.shapes.1)) {
                others[a.min(b)].push(a.max(b) as u32);
            }
        }
        let mut end = 0;
        let starts = others.iter().map(|others| {
            end += others.len() as u32;
            end
        });
        let starts = Vec::from_iter(std::iter::once(0).chain(starts));
        let pairs = model.contact_pairs.iter();
        self.paired = pairs.flat_map(|p| [p.shapes.0, p.shapes.1]).collect();
        self.plan.shape_surface = self.whole(vec![0; others.len()]);
        self.plan.paired_start = self.whole(starts);
        self.plan.paired_items = self.whole(others.concat());
    }

    /// What each shape brings to the decision which may touch; nothing touches where there is no filter.
    fn sides(&mut self, filter: Option<&CollisionFilter>) {
        let shapes = self.impulse.shapes();
        let mut words = Vec::new();
        let mut apart: Vec<&[usize]> = Vec::new();
        for shape in shapes.iter().map(|s| s.shape) {
            let Some(side) = filter.map(|filter| filter.side(shape)) else {
                words.extend([0; SIDE]);
                continue;
            };
            let flags = u32::from(side.collides) | u32::from(side.moves) << 1;
            words.extend([
                (side.owner as u32) << 2 | flags,
                side.membership,
                side.collides_with,
                side.group as u32,
                side.world as u32,
            ]);
            let owners = apart.len().max(side.owner + 1);
            apart.resize(owners, &[]);
            apart[side.owner] = side.apart;
        }
        let mut start = vec![0];
        let mut items = Vec::new();
        for owners in apart {
            items.extend(owners.iter().map(|owner| *owner as u32));
            start.push(items.len() as u32);
        }
        self.plan.sides = self.whole(words);
        self.plan.apart_start = self.whole(start);
        self.plan.apart_items = self.whole(items);
    }

    /// Who looks for pairs, in the order of the pairs.
    fn units(&mut self, large: &[bool]) {
        let mut units = Vec::new();
        for (i, is_large) in large.iter().enumerate() {
            if *is_large {
                let firsts = (i + 1..large.len()).step_by(UNIT);
                units.extend(firsts.flat_map(|first| [i as u32, first as u32]));
            } else {
                units.extend([i as u32, SMALL]);
            }
        }
        self.plan.own_units = (units.len() / 2) as u32;
        self.plan.unit_shapes = self.whole(units);
        let shapes = (0..).zip(large).filter(|(_, large)| **large);
        let shapes = Vec::from_iter(shapes.map(|(i, _)| i));
        self.plan.large = shapes.len() as u32;
        self.plan.large_shapes = self.whole(shapes);
    }

    /// Where joints are, and where their numbers lie.
    fn tie(&mut self) {
        let Some(joints) = &self.joints else { return };
        self.plan.own_joints = joints.count() as u32;
        self.plan.given_numbers = (joints.constants() * joints.count()) as u32;
        self.plan.law_numbers = joints.law_numbers() as u32;
        self.plan.tied = self.impulse.tied_state(0).start as u32;
        let (ties, runs) = (joints.ties.clone(), joints.runs.clone());
        let seats = joints.seats.clone();
        self.plan.joint_runs = runs.len() as u32 - 1;
        self.plan.ties = self.whole(ties);
        self.plan.joint_seats = self.whole(seats);
        self.plan.joint_run = self.whole(runs.into_flattened());
    }
}

/// Whether any two shapes of these forms may touch.
fn meet(impulse: &Impulse, filter: Option<&CollisionFilter>, forms: [Form; 2]) -> bool {
    let shapes = impulse.shapes().iter();
    let [a, b] = forms.map(|form| shapes.clone().filter(move |s| form_of(s) == form));
    let mut pairs = a.flat_map(|a| b.clone().map(|b| (a.shape, b.shape)));
    filter.is_some_and(|filter| pairs.any(|(a, b)| filter.may_collide(a, b)))
}

fn form_of(shape: &Collider) -> Form {
    (shape.kind, shape.corners)
}

/// Whole numbers of a group's places, as the shader counts them.
pub(crate) const PLACES: usize = 19;

fn words_of(tables: &PairTables, [of_a, of_b]: [usize; 2]) -> [u32; PLACES] {
    let PairPlaces {
        size: [a, b],
        placed: [c, d],
        corners: [e, f, g],
        margin,
        known,
        listed,
        points: [h, i],
        mesh: [j, k, l, m],
    } = tables.places();
    let sooner = usize::from(tables.takes_long());
    [
        a, b, c, d, e, f, g, margin, known, listed, h, i, sooner, of_a, of_b, j, k, l, m,
    ]
    .map(|n| n as u32)
}

pub(crate) fn unsupported(what: &'static str, remedy: &'static str) -> PilesError {
    PilesError::Unsupported { what, remedy }
}
