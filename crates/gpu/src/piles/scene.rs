//! A model of piles as a card has it: constants, and what is worked on together.

use super::joints::Joints;
use super::meshes::Meshes;
use super::plan::{GROUPS, Plan};
use super::steps::{CONTACTS, PAIRS};
use crate::memory::NUMBER;
use crate::{Gpu, GpuError};
use collide::{Route, kind};
use model::{CollisionFilter, Model, ShapeId};
use numbers::trace::Program;
use records::PilePrograms;
use rigid::impulse::pair::{PairPlaces, PairTables, solid};
use rigid::impulse::{
    Collider, FARTHEST, FREE_TURN, HELD_TURN, Impulse, NEARBY, WORLD, global, grip, mass, row,
};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::iter::repeat_n;
use std::sync::Arc;

/// What all worlds of a model have in common.
#[derive(Debug)]
pub(super) struct Scene {
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
    paired: HashSet<ShapeId>,
    surfaces: Vec<u32>,
    /// Whether there may be blows.
    pub bounces: bool,
    /// With the places of constants, and not yet those of what steps need.
    pub plan: Plan,
}

/// The constants of the solver.
#[derive(Debug)]
pub(super) struct Parameters {
    /// Those of the model.
    common: Vec<f32>,
    /// Those of each world, where worlds have their own.
    own: Vec<Vec<f32>>,
}

impl Parameters {
    /// Those of a world. Where a batch has more room than worlds, of one that is not, too.
    pub fn of(&self, world: usize) -> &[f32] {
        self.own.get(world).unwrap_or(&self.common)
    }
    /// Whether worlds have their own.
    pub fn differ(&self) -> bool {
        !self.own.is_empty()
    }
    fn all(&self) -> impl Iterator<Item = &Vec<f32>> + Clone {
        std::iter::once(&self.common).chain(&self.own)
    }
}

/// Pairs that one kernel meets.
#[derive(Debug)]
pub(super) struct Group {
    pub tables: PairTables,
    /// For how many triangles of A and of B a pair has room; 0 for what is not met as a mesh.
    pub triangles: [usize; 2],
    pub program: Program,
    /// What tells sooner which of them are apart, where that is worth its while.
    pub apart: Option<Program>,
}

/// Kind and number of corners.
pub(super) type Form = (usize, usize);

/// Others that a unit of work looks at for a large shape.
pub(super) const UNIT: usize = 64;
/// Words of what a shape brings to the decision which may touch.
pub(super) const SIDE: usize = 5;
/// No first of these: the unit is a small shape.
const SMALL: u32 = u32::MAX;
/// Numbers of a body while a step runs: behind its row, what it has of free velocity before blows.
pub(super) const ROW: usize = row::WIDTH + 6;
/// Numbers of what two surfaces make of a contact.
pub(super) const SURFACE: usize = 9;
/// Shapes of all worlds of a batch, at most: contacts name theirs by numbers that stand for whole ones up to there.
const NAMES: u32 = 1 << f32::MANTISSA_DIGITS;
/// Surfaces that differ, at most.
const SURFACES: usize = 1024;

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
        gpu: &Gpu,
        impulse: &Impulse,
        model: &Model,
        filter: Option<&CollisionFilter>,
        worlds: usize,
    ) -> Result<Self, GpuError> {
        let parameters: Vec<_> = impulse.parameters().iter().map(|x| *x as f32).collect();
        let forms: BTreeSet<_> = impulse.shapes().iter().map(form_of).collect();
        let forms = Vec::from_iter(forms);
        let mut scene = Self {
            impulse: Arc::new(impulse.clone()),
            programs: PilePrograms::record()?,
            joints: Joints::new(impulse, &parameters)?,
            meshes: Meshes::new(impulse, model),
            groups: Vec::new(),
            constants: Vec::new(),
            whole: Vec::new(),
            paired: HashSet::new(),
            surfaces: Vec::new(),
            bounces: false,
            plan: Plan::default(),
            parameters: Parameters {
                common: parameters.clone(),
                own: Vec::new(),
            },
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
        scene.spread(gpu, worlds)?;
        Ok(scene)
    }

    /// Gives each world constants of its own.
    ///
    /// # Errors
    /// Surfaces differ in too many ways.
    pub fn differ(&mut self, own: Vec<Vec<f32>>) -> Result<(), GpuError> {
        self.parameters.own = own;
        if let Some(joints) = &mut self.joints {
            let mut all = self.parameters.all();
            joints.inertia = all.any(|set| self.impulse.has_inertia(set));
        }
        self.surfaces()?;
        self.place_constants();
        Ok(())
    }
    /// Whether worlds may have these constants, besides those that they have.
    ///
    /// # Errors
    /// They may not: contacts know of one gravity; surfaces differ in too many ways, or take too much room.
    pub fn takes(&self, gpu: &Gpu, sets: &[Vec<f32>]) -> Result<(), GpuError> {
        let usual = self.impulse.weight(&self.parameters.common);
        for set in sets {
            let differs = (self.impulse.weight(set) - usual).abs() > 1e-5 * usual;
            if differs && (self.impulse.bounces(set) || self.impulse.sticks(set)) {
                return Err(unsupported(
                    "gravity of another strength in a world in which things bounce, or stick better than they slide",
                    "give all worlds the same, or run on the processor",
                ));
            }
        }
        let [_, kinds] = self.kinds(self.parameters.all().chain(sets))?;
        let surfaces = u64::from(self.plan.surfaces.pow(2));
        let more = ((kinds.len() as u64).pow(2) - surfaces) * SURFACE as u64;
        let own = u64::from(self.own_length()) + more;
        let bytes = (self.constants.len() as u64 + own * u64::from(self.plan.worlds)) * NUMBER;
        if bytes > gpu.most_bytes() {
            return Err(GpuError::Parameters {
                bytes,
                most: gpu.most_bytes(),
                card: gpu.name().to_owned(),
            });
        }
        Ok(())
    }

    /// Places worlds side by side, as many as a card has room for.
    fn spread(&mut self, gpu: &Gpu, worlds: usize) -> Result<(), GpuError> {
        let alone = self.plan.of_worlds(1);
        let joints = self.joints.as_ref().map_or(0, Joints::width);
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
        let things = gpu.most_invocations() / things.into_iter().max().unwrap_or(0).max(1);
        let named = NAMES / alone.shapes.max(1);
        let numbers = (gpu.most_bytes() / NUMBER).min(u32::MAX.into()) / u64::from(longest);
        let most = numbers.min(things.min(named).max(1).into()) as usize;
        if most == 0 {
            return Err(GpuError::TooLarge {
                bytes: u64::from(longest) * NUMBER,
                most: gpu.most_bytes(),
                card: gpu.name().to_owned(),
            });
        }
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
    pub fn most_pairs(&self, gpu: &Gpu, of_mesh: bool) -> u32 {
        let [parameters, scratch] = self.pair_lengths(of_mesh);
        let bytes = parameters.max(scratch) as u64 * NUMBER;
        u32::try_from(gpu.most_bytes() / bytes).unwrap_or(u32::MAX)
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
    ) -> Result<(), GpuError> {
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

    /// Constants of which each world may have its own, one kind after the other.
    fn own_constants(&self, parameters: &[f32]) -> [Vec<f32>; 5] {
        let impulse = &self.impulse;
        let shapes = 0..impulse.shapes().len();
        let corners = shapes.clone().map(|i| impulse.corners_of(i, parameters));
        let grown = |i: usize| (impulse.widest_margin(i as u32, parameters) + NEARBY) as f32;
        [
            corners.flatten().copied().collect(),
            impulse.solids(parameters).to_vec(),
            shapes.map(grown).collect(),
            self.surface_table(parameters),
            self.turns(parameters),
        ]
    }
    /// Where these lie: behind what all worlds have in common.
    fn place_constants(&mut self) {
        let own = self.own_constants(self.parameters.of(0));
        let mut end = self.constants.len() as u32;
        let places = own.each_ref().map(|numbers| {
            end += numbers.len() as u32;
            end - numbers.len() as u32
        });
        let plan = &mut self.plan;
        [
            plan.corners,
            plan.solids,
            plan.grown,
            plan.surface,
            plan.turn,
        ] = places;
        let length = end - self.constants.len() as u32;
        plan.own_constants = if self.parameters.differ() { length } else { 0 };
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
        let number = |id: ShapeId| shapes.iter().position(|s| s.shape == id);
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

    /// Which kind of surface each shape has, and a shape of each kind: those of one kind are alike in all of these sets. A
    /// shape of a pair that has a surface of its own is of no other's kind.
    fn kinds<'a>(
        &self,
        sets: impl Iterator<Item = &'a Vec<f32>> + Clone,
    ) -> Result<[Vec<u32>; 2], GpuError> {
        let mut of_shape = Vec::new();
        let mut examples: Vec<u32> = Vec::new();
        let mut known = HashMap::new();
        for (shape, collider) in self.impulse.shapes().iter().enumerate() {
            let numbers = sets.clone();
            let numbers = numbers.flat_map(|set| self.impulse.surface_of(shape, set));
            let mut bits: Vec<_> = numbers.map(|x| x.to_bits()).collect();
            if self.paired.contains(&collider.shape) {
                bits.push(shape as u32);
            }
            of_shape.push(*known.entry(bits).or_insert_with(|| {
                examples.push(shape as u32);
                examples.len() as u32 - 1
            }));
        }
        if examples.len() > SURFACES {
            return Err(unsupported(
                "so many surfaces",
                "give more shapes the same one, or run on the processor",
            ));
        }
        Ok([of_shape, examples])
    }
    fn surfaces(&mut self) -> Result<(), GpuError> {
        let [of_shape, examples] = self.kinds(self.parameters.all())?;
        let mut all = self.parameters.all();
        self.bounces = all.any(|set| self.impulse.bounces(set));
        self.plan.surfaces = examples.len() as u32;
        let at = self.plan.shape_surface as usize;
        self.whole[at..][..of_shape.len()].copy_from_slice(&of_shape);
        self.surfaces = examples;
        Ok(())
    }

    /// What each two surfaces make of a contact.
    fn surface_table(&self, parameters: &[f32]) -> Vec<f32> {
        let mut table = Vec::new();
        for a in &self.surfaces {
            for b in &self.surfaces {
                let s = self.impulse.surface([*a, *b], parameters);
                let [stiffness, damping] = s.spring;
                table.extend([s.friction, s.restitution, s.torsion, s.rolling]);
                table.extend([stiffness, damping, s.settling, s.sticking]);
                table.push(self.impulse.margin([*a, *b], parameters).into());
            }
        }
        table.into_iter().map(|x| x as f32).collect()
    }

    /// What a body's spin [rad/s] is multiplied by that it may be 1 before a step is cut into parts.
    fn turns(&self, parameters: &[f32]) -> Vec<f32> {
        let impulse = &self.impulse;
        let length = impulse.settings().substep();
        let mut turns = vec![0.0; impulse.rows()];
        for (i, shape) in impulse.shapes().iter().enumerate() {
            if shape.row != WORLD && !impulse.is_centred(i, parameters) {
                turns[shape.row as usize] = (length / FREE_TURN) as f32;
            }
        }
        let held = self.joints.iter().flat_map(|joints| &joints.seats);
        for row in held {
            turns[*row as usize] = (length / HELD_TURN) as f32;
        }
        // Without what does not move.
        turns.split_off(1)
    }

    /// Where joints are, and where their numbers lie.
    fn tie(&mut self) {
        let Some(joints) = &self.joints else { return };
        self.plan.own_joints = joints.count() as u32;
        self.plan.given_numbers = (joints.given() * joints.count()) as u32;
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
pub(super) const PLACES: usize = 19;

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

fn unsupported(what: &'static str, remedy: &'static str) -> GpuError {
    GpuError::Unsupported { what, remedy }
}

impl Scene {
    /// The constants of a step that is cut into so many parts: those of the model, which contacts and joints read.
    pub fn common_globals(&self, parts: usize) -> [f32; global::WIDTH] {
        self.impulse.globals(&self.parameters.common, parts)
    }
    /// Those of each world from the first on.
    pub fn globals(&self, first: usize, parts: usize) -> Vec<[f32; global::WIDTH]> {
        let worlds = first..first + self.plan.worlds as usize;
        let of = |world| self.impulse.globals(self.parameters.of(world), parts);
        worlds.map(of).collect()
    }
    /// Constants of all bodies of worlds from the first on as their kernels read them, `[number][body]`, behind those of
    /// the step.
    pub fn body_constants(&self, first: usize) -> Vec<f32> {
        let impulse = &self.impulse;
        let worlds = first..first + self.plan.worlds as usize;
        let rows = worlds.flat_map(|world| {
            let parameters = self.parameters.of(world);
            let mut rows = vec![[0.0; mass::WIDTH + grip::WIDTH]; impulse.rows()];
            for (row, own) in rows.iter_mut().enumerate() {
                own[..mass::WIDTH].copy_from_slice(impulse.mass_of(row, parameters));
            }
            for (row, grip) in impulse.grips(parameters) {
                let own = rows[row][mass::WIDTH..].iter_mut();
                own.zip(grip).for_each(|(own, x)| *own = x as f32);
            }
            rows.split_off(1)
        });
        // Before them, what does not move in each world.
        let fixed = repeat_n([0.0; mass::WIDTH + grip::WIDTH], self.plan.worlds as usize);
        columns(&Vec::from_iter(fixed.chain(rows)))
    }
    /// The same of shapes.
    pub fn shape_constants(&self, first: usize) -> Vec<f32> {
        let impulse = &self.impulse;
        let worlds = first..first + self.plan.worlds as usize;
        let rows = worlds.flat_map(|world| {
            let parameters = self.parameters.of(world);
            (0..impulse.shapes().len()).map(|shape| {
                let mut own = [0.0; solid::WIDTH];
                own.copy_from_slice(impulse.solid_of(shape, parameters));
                own
            })
        });
        columns(&Vec::from_iter(rows))
    }
    /// Constants of which a world may have its own.
    fn own_length(&self) -> u32 {
        self.plan.turn + self.plan.own_bodies - self.constants.len() as u32
    }
    /// Numbers of all constants of a batch.
    pub fn constants_length(&self) -> u32 {
        let sets = if self.parameters.differ() {
            self.plan.worlds
        } else {
            1
        };
        self.constants.len() as u32 + sets * self.own_length()
    }
    /// All constants of worlds from the first on.
    pub fn constants(&self, first: usize) -> Vec<f32> {
        let sets = match self.parameters.differ() {
            true => first..first + self.plan.worlds as usize,
            false => 0..1,
        };
        let own = sets.flat_map(|world| self.own_constants(self.parameters.of(world)).concat());
        self.constants.iter().copied().chain(own).collect()
    }
}

/// Constants of a body and of a shape, behind those of the step.
pub(super) const BODY: usize = global::WIDTH + mass::WIDTH + grip::WIDTH;
pub(super) const SHAPE: usize = global::WIDTH + solid::WIDTH;

/// Rows of things as columns, `[number][thing]`.
fn columns<const N: usize>(rows: &[[f32; N]]) -> Vec<f32> {
    let own = (0..N).flat_map(|number| rows.iter().map(move |row| row[number]));
    own.collect()
}
