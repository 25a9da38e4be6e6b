//! A model of piles as a card has it: constants, and what is worked on together.

use super::joints::Joints;
use super::meshes::Meshes;
use super::plan::{GROUPS, Plan};
use crate::memory::NUMBER;
use crate::{Gpu, GpuError};
use collide::{Route, kind};
use model::{CollisionFilter, Model, ShapeId};
use numbers::trace::Program;
use records::PilePrograms;
use rigid::impulse::pair::{PairPlaces, PairTables, solid};
use rigid::impulse::{
    Collider, FARTHEST, FREE_TURN, HELD_TURN, Impulse, NEARBY, WORLD, global, grip, mass,
};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::sync::Arc;

/// What all worlds of a model have in common.
#[derive(Debug)]
pub(super) struct Scene {
    pub impulse: Arc<Impulse>,
    pub programs: PilePrograms,
    pub joints: Option<Joints>,
    meshes: Meshes,
    pub parameters: Vec<f32>,
    pub groups: Vec<Group>,
    pub constants: Vec<f32>,
    pub whole: Vec<u32>,
    /// Constants of bodies and shapes as their kernels read them, `[number][body]`; the first ones are those of a
    /// [step](Self::globals).
    pub body_parameters: Vec<f32>,
    pub shape_parameters: Vec<f32>,
    /// Whether there may be blows.
    pub bounces: bool,
    /// With the places of constants, and not yet those of what steps need.
    pub plan: Plan,
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
/// Numbers of what two surfaces make of a contact.
pub(super) const SURFACE: usize = 9;
/// Surfaces that differ, at most.
const SURFACES: usize = 1024;

impl Group {
    /// Whether anything is met as a mesh.
    pub fn has_mesh(&self) -> bool {
        self.triangles[1] > 0
    }
}

impl Scene {
    /// # Errors
    /// The model has what cards do not know of piles.
    pub fn new(
        impulse: &Impulse,
        model: &Model,
        filter: Option<&CollisionFilter>,
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
            body_parameters: body_parameters(impulse, &parameters),
            shape_parameters: shape_parameters(impulse, &parameters),
            bounces: false,
            plan: Plan::default(),
            parameters: parameters.clone(),
        };
        let settings = impulse.settings();
        let shapes = impulse.shapes();
        scene.plan.bodies = impulse.rows() as u32;
        scene.plan.shapes = shapes.len() as u32;
        scene.plan.remembered = impulse.capacity() as u32;
        scene.plan.alive = impulse.alive() as u32;
        scene.plan.body_state = impulse.body_state(0) as u32;
        let places = impulse.memory_places().map(|n| n as u32);
        [scene.plan.count, scene.plan.forgotten, scene.plan.memory] = places;
        scene.plan.small_steps = settings.contact_iterations as u32;
        scene.plan.fastest = (settings.speed_limit as f32).next_down();
        scene.plan.farthest = FARTHEST as f32;
        scene.groups_of(&forms, &parameters, filter)?;
        let large = scene.large(&parameters);
        scene.shapes(&parameters, &forms, &large);
        scene.mesh();
        scene.sides(filter);
        scene.paired(model);
        scene.units(&large);
        scene.surfaces(&parameters, model)?;
        scene.turns(&parameters);
        scene.tie();
        Ok(scene)
    }

    /// The constants of a step that is cut into so many parts.
    pub fn globals(&self, parts: usize) -> [f32; global::WIDTH] {
        self.impulse.globals(&self.parameters, parts)
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

    /// Adds constants; where they begin.
    fn constants(&mut self, numbers: impl IntoIterator<Item = f32>) -> u32 {
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

    fn shapes(&mut self, parameters: &[f32], forms: &[Form], large: &[bool]) {
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
        let mut corners = Vec::new();
        let mut first = Vec::new();
        for i in all.clone() {
            first.extend([corners.len() as u32, u32::from(large[i])]);
            corners.extend_from_slice(impulse.corners_of(i, parameters));
        }
        self.plan.first_corner = self.whole(first);
        self.plan.corners = self.constants(corners);
        self.plan.solids = self.constants(impulse.solids(parameters).iter().copied());
        let grown = |i: usize| (impulse.widest_margin(i as u32, parameters) + NEARBY) as f32;
        self.plan.grown = self.constants(all.map(grown));
    }

    /// The triangles of all meshes, in groups of clusters.
    fn mesh(&mut self) {
        let Meshes { data, groups, .. } = std::mem::take(&mut self.meshes);
        let single = |numbers: Vec<f64>| numbers.into_iter().map(|x| x as f32);
        let ranges = |ranges: Vec<[usize; 2]>| ranges.into_iter().flatten().map(|i| i as u32);
        let (boxes, rows): (Vec<_>, Vec<_>) = data.groups().unzip();
        self.plan.mesh_groups = self.constants(single(boxes.concat()));
        self.plan.mesh_group_rows = self.whole(ranges(rows));
        let (boxes, rows): (Vec<_>, Vec<_>) = data.clusters().unzip();
        self.plan.mesh_clusters = self.constants(single(boxes.concat()));
        self.plan.mesh_cluster_rows = self.whole(ranges(rows));
        let triangles = data.triangles().iter();
        let triangles = triangles.flat_map(|t| t.numbers().map(|x| x as f32));
        self.plan.mesh_triangles = self.constants(triangles.collect::<Vec<_>>());
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
        self.plan.units = (units.len() / 2) as u32;
        self.plan.unit_shapes = self.whole(units);
        let shapes = (0..).zip(large).filter(|(_, large)| **large);
        let shapes = Vec::from_iter(shapes.map(|(i, _)| i));
        self.plan.large = shapes.len() as u32;
        self.plan.large_shapes = self.whole(shapes);
    }

    /// What each two surfaces make of a contact. A shape of a pair that has a surface of its own is of no other's kind.
    fn surfaces(&mut self, parameters: &[f32], model: &Model) -> Result<(), GpuError> {
        let impulse = Arc::clone(&self.impulse);
        let pairs = model.contact_pairs.iter();
        let paired: HashSet<_> = pairs
            .flat_map(|pair| [pair.shapes.0, pair.shapes.1])
            .collect();
        let mut of_shape = Vec::new();
        let mut examples: Vec<u32> = Vec::new();
        let mut known = HashMap::new();
        for (shape, collider) in impulse.shapes().iter().enumerate() {
            let numbers = impulse.surface_of(shape, parameters).iter();
            let mut bits: Vec<_> = numbers.map(|x| x.to_bits()).collect();
            if paired.contains(&collider.shape) {
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
        let mut table = Vec::new();
        for a in &examples {
            for b in &examples {
                let s = impulse.surface([*a, *b], parameters);
                self.bounces |= s.restitution > 0.0;
                let [stiffness, damping] = s.spring;
                table.extend([s.friction, s.restitution, s.torsion, s.rolling]);
                table.extend([stiffness, damping, s.settling, s.sticking]);
                table.push(impulse.margin([*a, *b], parameters).into());
            }
        }
        self.plan.surfaces = examples.len() as u32;
        self.plan.shape_surface = self.whole(of_shape);
        self.plan.surface = self.constants(table.into_iter().map(|x| x as f32));
        Ok(())
    }

    /// What a body's spin [rad/s] is multiplied by that it may be 1 before a step is cut into parts.
    fn turns(&mut self, parameters: &[f32]) {
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
        self.plan.turn = self.constants(turns);
    }

    /// Where joints are, and where their numbers lie.
    fn tie(&mut self) {
        self.plan.forces = self.impulse.lengths().state as u32;
        self.plan.given = self.plan.forces + 6 * self.plan.bodies;
        let Some(joints) = &self.joints else { return };
        self.plan.joints = joints.count() as u32;
        self.plan.law_numbers = joints.law_numbers() as u32;
        self.plan.tied = self.impulse.tied_state(0).start as u32;
        let (ties, runs) = (joints.ties.clone(), joints.runs.clone());
        self.plan.joint_runs = runs.len() as u32 - 1;
        self.plan.ties = self.whole(ties);
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

/// A row of each thing as columns, `[number][thing]`.
fn columns(things: usize, width: usize, rows: &[f32]) -> Vec<f32> {
    let own = (0..width).flat_map(|number| (0..things).map(move |i| rows[i * width + number]));
    own.collect()
}

fn body_parameters(impulse: &Impulse, parameters: &[f32]) -> Vec<f32> {
    let bodies = impulse.rows();
    let mut grips = vec![0.0; grip::WIDTH * bodies];
    for (row, grip) in impulse.grips(parameters) {
        let own = grips[grip::WIDTH * row..].iter_mut();
        own.zip(grip).for_each(|(own, x)| *own = x as f32);
    }
    let masses = columns(bodies, mass::WIDTH, impulse.masses(parameters));
    let room = vec![0.0; global::WIDTH * bodies];
    [room, masses, columns(bodies, grip::WIDTH, &grips)].concat()
}

fn shape_parameters(impulse: &Impulse, parameters: &[f32]) -> Vec<f32> {
    let shapes = impulse.shapes().len();
    let room = vec![0.0; global::WIDTH * shapes];
    [
        room,
        columns(shapes, solid::WIDTH, impulse.solids(parameters)),
    ]
    .concat()
}
