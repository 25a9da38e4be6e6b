//! A model as tables, and the numbers of its worlds.

use super::body::push;
use super::joint::{Ties, inner_frames, is_bare};
use super::pair::solid;
use super::tables::{BodyTables, POINTS, global, grip, mass, row};
use super::{memory, surface};
use crate::contacts::tables::{Solid, Thin, thickness, way_through};
use crate::contacts::{ContactPlan, Corners, PUSH_OUT};
use crate::input::InputTables;
use crate::output::body;
use crate::tables::{Filler, UNBOUNDED};
use crate::{Featherstone, Lengths, OutputTables, Settings, SolverError};
use collide::kind;
use glam::{DQuat, DVec3};
use model::{
    BodyId, BodyKind, CollisionFilter, Geometry, Joint, JointId, JointKind, MassProperties, Model,
    Pose, Shape, ShapeId,
};
use numbers::machine::space::{Parameter, State as StateMemory};
use numbers::{Cpu, Float, PerWorld, Table};
use std::collections::{HashMap, HashSet};
use std::ops::Range;

pub(super) const NAME: &str = "impulse";

/// Row of what does not move.
pub const WORLD: u32 = 0;

/// Longest turn [rad] in a step of a body that joints hold, while its inertia is taken not to turn.
pub const HELD_TURN: f64 = 0.125;

/// Longest turn [rad] in a step of bodies that no joint holds and that are no balls, while their arms are taken not to turn.
pub const FREE_TURN: f64 = 0.5;

/// Gap [m] at which two shapes touch even if nothing moves.
pub const NEARBY: f64 = 1e-4;

/// Points nearer than this share of the larger shape's radius, of one pair, are the same.
pub const SAME_PLACE: f64 = 0.05;

/// Normals are of one contact that turned if the cosine of the angle between them is larger.
pub const SAME_NORMAL: f64 = 0.5;

/// Nothing is farther from the origin [m].
pub const FARTHEST: f64 = 1e9;

/// What meets no faster than it falls in so many steps does not bounce.
pub(super) const RESTING: f64 = 2.0;

/// Time [s] for which all of an island must have been slow before it sleeps.
pub const SLEEP_AFTER: f64 = 0.5;

/// Contacts that a world remembers from step to step, for each body that moves. Sixteen more for
/// small models.
const REMEMBERED: usize = 6;

/// A ball nearer than this share of its radius to its body's centre of mass is about it.
const CENTRED: f64 = 1e-3;

/// Fields of a body's state.
pub mod state {
    /// Centre of mass [m].
    pub const CENTER: usize = 0;
    /// Orientation of the principal axes.
    pub const ORIENTATION: usize = 3;
    /// Velocity [m/s], then spin [rad/s].
    pub const VELOCITY: usize = 7;
    /// The same before the last step.
    pub const BEFORE: usize = 13;
    /// For how long [s] the body has been slow.
    pub const REST: usize = 19;
    /// Numbers in a row.
    pub const WIDTH: usize = 20;
}

/// A colliding shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collider {
    /// The shape in the model.
    pub shape: ShapeId,
    /// Row of the body that carries it; [`WORLD`] for what does not move.
    pub row: u32,
    /// See [`collide::kind`].
    pub kind: usize,
    /// How many corners it has, those repeated counted: a power of two for all hulls.
    pub corners: usize,
    /// The first of them among those of all.
    first_corner: usize,
    /// It touches but never pushes.
    pub sensor: bool,
}

/// A model compiled for sequential impulses.
#[derive(Clone, Debug, PartialEq)]
pub struct Impulse {
    /// Dynamic bodies by row, row 0 apart.
    pub(super) bodies: Vec<BodyId>,
    /// For each body of the model, its row.
    pub(super) rows: Vec<u32>,
    /// Free joints to the world along which nothing acts.
    pub(super) free: Vec<Free>,
    /// All other joints.
    pub(super) ties: Ties,
    pub(super) shapes: Vec<Collider>,
    pub(super) paired: HashMap<[u32; 2], usize>,
    pub(super) mass: Table<Parameter, { mass::WIDTH }>,
    /// The model's frame in the body's own, or in the world.
    pub(super) frame: Table<Parameter, 7>,
    solid: Table<Parameter, { solid::WIDTH }>,
    corners: Table<Parameter, 3>,
    pub(super) surface: Table<Parameter, { surface::field::WIDTH }>,
    pub(super) gravity: Table<Parameter, 3>,
    pub(super) alive: Table<StateMemory>,
    pub(super) state: Table<StateMemory, { state::WIDTH }>,
    pub(super) remembered: Table<StateMemory>,
    /// How many contacts there was no room for, since the world was reset.
    pub(super) forgotten: Table<StateMemory>,
    pub(super) memory: Table<StateMemory, { memory::remembered::WIDTH }>,
    /// Lengths [s] of the small steps and of the step by which what is remembered was given.
    pub(super) given_in: Table<StateMemory, 2>,
    pub(super) capacity: usize,
    state_length: usize,
    pub(super) input: InputTables,
    pub(super) output: OutputTables,
    pub(super) settings: Settings,
    parameters: Vec<f64>,
    links: Vec<u32>,
    tree: Featherstone,
}

/// A free joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Free {
    pub joint: JointId,
    pub body: BodyId,
    pub parent_frame: Pose,
    pub child_frame: Pose,
    /// First coordinate and first degree of freedom.
    pub coordinate: usize,
    pub dof: usize,
}

/// The body's own frame in the model's: centre of mass and principal axes.
pub(super) fn own_frame(body: &model::Body) -> (DVec3, Pose) {
    let mass = MassProperties {
        mass: body.mass,
        center: body.center,
        inertia: body.inertia,
    };
    let (moments, axes) = mass.principal();
    (moments, Pose::new(body.center, axes))
}

pub(super) fn unsupported(what: &'static str, name: &str, remedy: &'static str) -> SolverError {
    SolverError::Unsupported {
        solver: NAME,
        what,
        name: name.to_owned(),
        remedy,
    }
}

/// Whether a model is what this solver is for: several things that touch, free or of passive joints, or more things that
/// may than other solvers have room for.
pub fn suits(model: &Model) -> bool {
    let solid = |shape: &Shape| Solid::new(shape, NAME).is_ok();
    let mut touching = model.shapes.iter().filter(|shape| shape.collides);
    let drives = |dof: &model::Dof| dof.drive.stiffness > 0.0 || dof.drive.damping > 0.0;
    let driven = model.joints.iter().flat_map(|j| &j.dofs).any(drives);
    let passive = !driven && model.actuators.is_empty();
    let known = check(model).is_ok() && Ties::of(model).is_ok();
    // Last what looks at every two shapes.
    let takes = known && touching.all(solid);
    takes && ((passive && several(model)) || !ContactPlan::has_room(model))
}

/// Whether several things move on their own, bodies or what joints make of them, and may touch.
fn several(model: &Model) -> bool {
    let moves = |body: &BodyId| model.bodies[body.0].kind == BodyKind::Dynamic;
    let hangs = |body: &BodyId| {
        let carrier = model.carrier(*body).map(|id| &model.joints[id.0]);
        let holds = carrier.filter(|joint| joint.kind != JointKind::Free);
        holds
            .and_then(|joint| joint.parent)
            .is_some_and(|p| moves(&p))
    };
    let bodies = (0..model.bodies.len()).map(BodyId).filter(moves);
    let things = bodies.filter(|body| !hangs(body));
    let free = (0..model.joints.len()).all(|j| is_bare(model, JointId(j)));
    things.take(2).count() == 2 && (free || CollisionFilter::new(model).pairs().next().is_some())
}

/// Refuses what ties coordinates together.
fn check(model: &Model) -> Result<(), SolverError> {
    match model.couplings.first() {
        Some(coupling) => Err(unsupported(
            "the coupling",
            &coupling.name,
            "use the solver `featherstone`, or `xpbd`",
        )),
        None => Ok(()),
    }
}

/// The bodies that move, and the row of each body.
pub(super) fn bodies_and_rows(model: &Model) -> (Vec<BodyId>, Vec<u32>) {
    let mut rows = vec![WORLD; model.bodies.len()];
    let mut bodies = Vec::new();
    for (i, body) in model.bodies.iter().enumerate() {
        if body.kind == BodyKind::Dynamic {
            bodies.push(BodyId(i));
            rows[i] = bodies.len() as u32;
        }
    }
    (bodies, rows)
}

impl Impulse {
    /// Compiles a model.
    ///
    /// # Errors
    /// Couplings, compliant joints, axes in an order or directions, or a law on a joint, that this solver
    /// does not know; a shape that no kernel collides.
    pub fn new(model: &Model, settings: &Settings) -> Result<Self, SolverError> {
        check(model)?;
        let (bodies, rows) = bodies_and_rows(model);
        let (mut parameters, mut state_length) = (0, 0);
        let row_of = |body: Option<BodyId>| body.map_or(WORLD, |id| rows[id.0]);
        let touching = touching(model);
        // Hulls of nearly as many corners are looked at side by side.
        let corners = Corners::new(with_corners(model, &touching), usize::next_power_of_two);
        let shapes = colliders(model, &touching, &corners, row_of)?;
        let capacity = REMEMBERED * bodies.len() + 16;
        let surfaces = shapes.len() + model.contact_pairs.len();
        let mut impulse = Self {
            free: (0..model.joints.len())
                .filter(|j| is_bare(model, JointId(*j)))
                .map(|j| Free::new(model, JointId(j), &model.joints[j]))
                .collect(),
            ties: Ties::new(model, &rows, &mut parameters, &mut state_length)?,
            paired: paired(model, &shapes),
            mass: Table::place(&mut parameters, bodies.len() + 1),
            frame: Table::place(&mut parameters, model.bodies.len()),
            solid: Table::place(&mut parameters, shapes.len()),
            corners: Table::place(&mut parameters, corners.rows()),
            surface: Table::place(&mut parameters, surfaces),
            gravity: Table::place(&mut parameters, 1),
            alive: Table::place(&mut state_length, 1),
            state: Table::place(&mut state_length, bodies.len() + 1),
            remembered: Table::place(&mut state_length, 1),
            forgotten: Table::place(&mut state_length, 1),
            memory: Table::place(&mut state_length, capacity),
            given_in: Table::place(&mut state_length, 1),
            capacity,
            state_length: 0,
            input: InputTables::new(model),
            output: OutputTables::new(model)
                .with_found_contacts(capacity * POINTS)
                .with_contact_torques()
                .with_sleep(model.bodies.len()),
            settings: *settings,
            parameters: Vec::new(),
            links: Vec::new(),
            tree: Featherstone::of_tree(model, settings),
            bodies,
            rows,
            shapes,
        };
        impulse.state_length = state_length;
        impulse.fill(model, &corners, parameters)?;
        Ok(impulse)
    }

    fn fill(
        &mut self,
        model: &Model,
        corners: &Corners,
        parameters: usize,
    ) -> Result<(), SolverError> {
        let mut f = Filler::new(parameters, 0);
        corners.fill(self.corners, &mut f);
        f.vec3(self.gravity, 0, 0, model.gravity);
        for (i, body) in model.bodies.iter().enumerate() {
            let row = self.rows[i] as usize;
            if body.kind == BodyKind::Static {
                f.pose(self.frame, i, 0, body.pose);
                continue;
            }
            let (moments, own) = own_frame(body);
            f.numbers(self.mass, row, mass::MASS, &[body.mass, body.mass.recip()]);
            f.vec3(self.mass, row, mass::MOMENTS, moments);
            f.vec3(self.mass, row, mass::INVERSE_MOMENTS, moments.recip());
            f.pose(self.frame, i, 0, own.inverse());
        }
        let [h, _] = self.lengths_of_steps();
        self.ties.fill(model, &inner_frames(model), h, &mut f);
        for (row, collider) in self.shapes.iter().enumerate() {
            let shape = &model.shapes[collider.shape.0];
            let solid = Solid::new(shape, NAME)?;
            let carrier = shape.body.map_or(Pose::IDENTITY, |id| match collider.row {
                WORLD => model.bodies[id.0].pose,
                _ => own_frame(&model.bodies[id.0]).1.inverse(),
            });
            f.pose(self.solid, row, solid::POSE, carrier * solid.pose);
            f.vec3(self.solid, row, solid::SIZE, solid.size);
            let extent = shape.geometry.half_extents();
            let extent = extent.unwrap_or(DVec3::splat(UNBOUNDED));
            f.vec3(self.solid, row, solid::EXTENT, extent);
            f.number(self.solid, row, solid::RADIUS, solid.radius);
            let thickness = thickness(&shape.geometry);
            f.number(self.solid, row, solid::THICKNESS, thickness);
            f.numbers(self.surface, row, 0, &surface::numbers_of(&shape.material));
        }
        for (i, pair) in model.contact_pairs.iter().enumerate() {
            let row = self.shapes.len() + i;
            f.numbers(self.surface, row, 0, &surface::numbers_of(&pair.material));
        }
        self.links = self.structure(model);
        self.parameters = f.parameters;
        Ok(())
    }

    /// All that two worlds must have in common besides where their numbers lie: who carries which
    /// shape, what may touch what, where joints are.
    fn structure(&self, model: &Model) -> Vec<u32> {
        let mut words = Vec::new();
        for collider in &self.shapes {
            let shape = &model.shapes[collider.shape.0];
            words.extend([collider.row, collider.kind as u32, collider.shape.0 as u32]);
            words.extend([collider.corners, collider.first_corner].map(|n| n as u32));
            words.extend([
                shape.membership,
                shape.collides_with,
                collider.sensor.into(),
            ]);
        }
        // The triangles of meshes are not among the numbers that worlds may have of their own.
        let meshes = self.shapes.iter().filter(|s| s.kind == kind::MESH);
        for collider in meshes {
            words.extend(words_of(&model.shapes[collider.shape.0].geometry));
        }
        for body in &model.bodies {
            words.extend([body.group as u32, body.world as u32]);
        }
        self.ties.structure(&mut words);
        for (a, b) in &model.exclusions {
            words.extend([a.map_or(u32::MAX, |a| a.0 as u32), b.0 as u32]);
        }
        for pair in &model.contact_pairs {
            words.extend([pair.shapes.0.0 as u32, pair.shapes.1.0 as u32]);
        }
        for frame in self
            .free
            .iter()
            .flat_map(|f| [f.parent_frame, f.child_frame])
        {
            let (p, q) = (frame.position.to_array(), frame.orientation.to_array());
            let bits = p.into_iter().chain(q).map(f64::to_bits);
            words.extend(bits.flat_map(|x| [x as u32, (x >> 32) as u32]));
        }
        words
    }

    /// The solver's name.
    pub fn name(&self) -> &'static str {
        NAME
    }
    /// Settings it was compiled with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }
    /// Numbers per world in each memory.
    pub fn lengths(&self) -> Lengths {
        Lengths {
            state: self.state_length,
            input: self.input.length,
            output: self.output.length,
            scratch: 0,
        }
    }
    /// Where the reported numbers lie.
    pub fn outputs(&self) -> OutputTables {
        self.output
    }
    /// The constants of the model.
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }
    /// The whole numbers of the model.
    pub fn links(&self) -> &[u32] {
        &self.links
    }
    /// Offset in the state of the number that is 1 while a world runs and 0 once it diverged.
    pub fn alive(&self) -> usize {
        self.alive.at(0, 0)
    }
    /// Rows of bodies, with that of what does not move.
    pub fn rows(&self) -> usize {
        self.bodies.len() + 1
    }
    /// The colliding shapes.
    pub fn shapes(&self) -> &[Collider] {
        &self.shapes
    }
    /// Whether forces act on bodies from outside, besides those along the axes of joints.
    pub fn is_pushed<T: Float>(&self, input: &[T]) -> bool {
        let mut given = self.pushes(input).flat_map(|(_, given)| given);
        given.any(|x| x != T::zero())
    }
    /// How many contacts a world remembers.
    pub fn capacity(&self) -> usize {
        self.capacity
    }
    /// The state of a world whose joints have the given coordinates and velocities.
    pub fn initial(&self, position: &[f64], velocity: &[f64]) -> Vec<f64> {
        let mut state = vec![0.0; self.state_length];
        state[self.alive()] = 1.0;
        state[self.state.at(0, state::ORIENTATION + 3)] = 1.0;
        state[self.given_in.at(0, 0)..][..2].copy_from_slice(&self.lengths_of_steps());
        self.ties.initial(&mut state);
        self.place(position, velocity, &mut state);
        state
    }
    /// Gives the joints of a state other coordinates and velocities; all else in it stays.
    pub fn place(&self, position: &[f64], velocity: &[f64], state: &mut [f64]) {
        self.take_over(&self.tree.bodies(position, velocity), state);
        self.ties
            .place([position, velocity], &self.parameters, state);
    }
    /// Changes the velocities of the joints of a state, which have these coordinates, from some to others; all else in it
    /// stays, and what else bodies move by. Bodies that get faster or slower are awake.
    pub fn push(&self, position: &[f64], velocities: [&[f64]; 2], state: &mut [f64]) {
        let placed = velocities.map(|velocity| {
            let mut placed = state.to_vec();
            self.place(position, velocity, &mut placed);
            placed
        });
        let gained = |i: usize| placed[1][i] - placed[0][i];
        for row in 1..self.rows() {
            let at = self.body_state(row);
            let moving = at + state::VELOCITY..at + state::REST;
            if moving.clone().any(|i| gained(i) != 0.0) {
                state[at + state::REST] = 0.0;
            }
            moving.for_each(|i| state[i] += gained(i));
        }
        let rates = (0..self.ties()).flat_map(|tie| self.tied_rates(tie));
        rates.for_each(|i| state[i] += gained(i));
    }
    /// Where in a state bodies and joints are and move, and have moved.
    pub fn motion(&self) -> Vec<Range<usize>> {
        let rows = (1..self.rows()).map(|row| self.body_state(row));
        let bodies = rows.map(|at| at..at + state::REST);
        let ties = (0..self.ties()).map(|tie| self.tied_state(tie));
        bodies.chain(ties).collect()
    }
    /// Takes over bodies that stood and moved so, 13 numbers each: see [`body`].
    pub fn take_over(&self, bodies: &[f64], state: &mut [f64]) {
        for (i, &id) in self.bodies.iter().enumerate() {
            let row = &mut state[self.state.at(i + 1, 0)..][..state::WIDTH];
            let b = &bodies[id.0 * body::WIDTH..][..body::WIDTH];
            let vec3 = |field| DVec3::from_slice(&b[field..]);
            let model_frame = Pose::new(
                vec3(body::POSITION),
                DQuat::from_slice(&b[body::ORIENTATION..]),
            );
            let inner = pose_at(&self.parameters, self.frame.at(id.0, 0));
            let own = model_frame * inner.inverse();
            let w = vec3(body::ANGULAR_VELOCITY);
            let v = vec3(body::VELOCITY) + w.cross(own.position - model_frame.position);
            row[state::CENTER..][..3].copy_from_slice(&own.position.to_array());
            row[state::ORIENTATION..][..4].copy_from_slice(&own.orientation.to_array());
            for field in [state::VELOCITY, state::BEFORE] {
                row[field..][..3].copy_from_slice(&v.to_array());
                row[field + 3..][..3].copy_from_slice(&w.to_array());
            }
            row[state::REST] = 0.0;
        }
    }

    /// Lengths [s] of a small step and of a step.
    pub(super) fn lengths_of_steps(&self) -> [f64; 2] {
        let long = self.settings.substep();
        [long / self.settings.contact_iterations as f64, long]
    }
    /// Strength of gravity [m/s²].
    pub fn weight<T: Float>(&self, parameters: &[T]) -> f64 {
        let squares = self.gravity(parameters).iter().map(|x| x.to_f64().powi(2));
        squares.sum::<f64>().sqrt()
    }
    /// The constants of a step, or of one of the parts into which it is cut: see [`global`].
    pub fn globals<T: Float>(&self, parameters: &[T], parts: usize) -> [T; global::WIDTH] {
        let long = self.settings.substep() / parts as f64;
        let steps = (self.settings.contact_iterations / parts) as f64;
        let [x, y, z] = [0, 1, 2].map(|i| self.gravity(parameters)[i].to_f64());
        // Of a whole step: how it is cut follows from what spins elsewhere in the world.
        let resting = RESTING * self.weight(parameters) * self.settings.substep();
        [
            long / steps,
            steps / long,
            steps,
            x,
            y,
            z,
            PUSH_OUT,
            resting,
        ]
        .map(T::from_f64)
    }

    /// The constants of all bodies, by row: see [`mass`].
    pub fn masses<'a, T>(&self, parameters: &'a [T]) -> &'a [T] {
        &parameters[self.mass.at(0, 0)..self.mass.at(self.rows(), 0)]
    }
    /// A body's constants.
    pub fn mass_of<'a, T>(&self, row: usize, parameters: &'a [T]) -> &'a [T] {
        &parameters[self.mass.at(row, 0)..][..mass::WIDTH]
    }
    /// The constants of all colliding shapes: see [`solid`].
    pub fn solids<'a, T>(&self, parameters: &'a [T]) -> &'a [T] {
        &parameters[self.solid.at(0, 0)..self.solid.at(self.shapes.len(), 0)]
    }
    /// A colliding shape's constants.
    pub fn solid_of<'a, T>(&self, shape: usize, parameters: &'a [T]) -> &'a [T] {
        &parameters[self.solid.at(shape, 0)..][..solid::WIDTH]
    }
    /// The radius of the ball about its centre that holds a colliding shape [m].
    pub fn radius_of<T: Float>(&self, shape: usize, parameters: &[T]) -> T {
        self.solid_of(shape, parameters)[solid::RADIUS]
    }
    /// The way [m] on which two colliding shapes get through each other.
    pub fn way_through<T: Float>(&self, shapes: [u32; 2], parameters: &[T]) -> T {
        let solids = shapes.map(|s| {
            let solid = self.solid_of(s as usize, parameters);
            Thin {
                half: solid[solid::THICKNESS].to_f64(),
                radius: solid[solid::RADIUS].to_f64(),
                mesh: self.shapes[s as usize].kind == kind::MESH,
            }
        });
        T::from_f64(way_through(solids))
    }
    /// Whether a colliding shape is a ball about its body's centre of mass, so that it stays in its place however it spins.
    pub fn is_centred<T: Float>(&self, shape: usize, parameters: &[T]) -> bool {
        let solid = self.solid_of(shape, parameters);
        let squares = solid[solid::POSE..][..3].iter().map(|x| x.to_f64().powi(2));
        let radius = solid[solid::RADIUS].to_f64();
        self.shapes[shape].kind == kind::SPHERE && squares.sum::<f64>() < (CENTRED * radius).powi(2)
    }
    /// The corners of a colliding shape about its centre [m], three numbers each.
    pub fn corners_of<'a, T>(&self, shape: usize, parameters: &'a [T]) -> &'a [T] {
        let collider = &self.shapes[shape];
        let first = self.corners.at(collider.first_corner, 0);
        &parameters[first..][..3 * collider.corners]
    }
    /// Gravity [m/s²].
    pub fn gravity<'a, T>(&self, parameters: &'a [T]) -> &'a [T] {
        &parameters[self.gravity.at(0, 0)..][..3]
    }
    /// What acts on the bodies from outside: for each row force and torque about its centre.
    pub fn wrenches<T: Float>(
        &self,
        state: &State<'_, T>,
        input: &[T],
        wrenches: &mut Vec<[T; 6]>,
    ) {
        wrenches.clear();
        wrenches.resize(self.rows(), [T::zero(); 6]);
        if !self.is_pushed(input) {
            return;
        }
        let t = BodyTables::new();
        let grips = self.grips(state.parameters);
        for ((row, given), (_, grip)) in self.pushes(input).zip(grips) {
            let mut numbers = [0.0; row::WIDTH];
            let turn = state.pose(row).orientation.to_array();
            numbers[row::ORIENTATION..][..4].copy_from_slice(&turn);
            numbers[row::WRENCH..][..6].copy_from_slice(&given.map(T::to_f64));
            let mut parameters = [0.0; global::WIDTH + mass::WIDTH + grip::WIDTH];
            parameters[t.grip.at(0, 0)..].copy_from_slice(&grip);
            push(
                &mut Cpu {
                    state: &mut numbers,
                    input: &[],
                    output: &mut [],
                    scratch: &mut [],
                    parameters: PerWorld(&parameters),
                    links: &[],
                },
                &t,
            );
            wrenches[row] = std::array::from_fn(|i| T::from_f64(numbers[row::WRENCH + i]));
        }
    }

    /// Bodies that free joints push, and by which force and torque, as [`push`] takes them.
    pub fn pushes<T: Float>(&self, input: &[T]) -> impl Iterator<Item = (usize, [T; 6])> {
        let forces = &input[self.input.force.start()..];
        self.free.iter().map(|free| {
            let given = std::array::from_fn(|i| forces[free.dof + i]);
            (self.rows[free.body.0] as usize, given)
        })
    }

    /// Where free joints push bodies, in the same order: their rows, and see [`grip`](mod@grip).
    pub fn grips<T: Float>(
        &self,
        parameters: &[T],
    ) -> impl Iterator<Item = (usize, [f64; grip::WIDTH])> {
        self.free.iter().map(|free| {
            let inner = pose_at(parameters, self.frame.at(free.body.0, 0));
            let frame = inner * free.child_frame;
            let force_frame = free.parent_frame.orientation.to_array();
            let mut grip = [0.0; grip::WIDTH];
            grip[grip::FORCE_FRAME..grip::FRAME].copy_from_slice(&force_frame);
            grip[grip::FRAME..][..3].copy_from_slice(&frame.position.to_array());
            grip[grip::FRAME + 3..].copy_from_slice(&frame.orientation.to_array());
            (self.rows[free.body.0] as usize, grip)
        })
    }

    /// Offset of a body's [`state`].
    pub fn body_state(&self, row: usize) -> usize {
        self.state.at(row, 0)
    }
}

/// The numbers of one world.
#[derive(Clone, Copy, Debug)]
pub struct State<'a, T> {
    /// Its solver.
    pub impulse: &'a Impulse,
    /// Its state.
    pub state: &'a [T],
    /// The model's constants.
    pub parameters: &'a [T],
}

impl<T: Float> State<'_, T> {
    /// Centre of mass and principal axes of a body.
    pub(super) fn pose(&self, row: usize) -> Pose {
        pose_at(self.state, self.impulse.state.at(row, state::CENTER))
    }
}

/// Seven numbers: position, orientation.
pub(super) fn pose_at<T: Float>(numbers: &[T], at: usize) -> Pose {
    let x = |i: usize| numbers[at + i].to_f64();
    Pose::new(
        DVec3::new(x(0), x(1), x(2)),
        DQuat::from_xyzw(x(3), x(4), x(5), x(6)),
    )
}

/// A mesh in whole numbers; nothing of what is none.
fn words_of(geometry: &Geometry) -> Vec<u32> {
    let Geometry::Mesh(mesh) = geometry else {
        return Vec::new();
    };
    let bits = mesh
        .vertices()
        .iter()
        .flat_map(|v| v.to_array().map(f64::to_bits));
    let vertices = bits.flat_map(|x| [x as u32, (x >> 32) as u32]);
    vertices
        .chain(mesh.triangles().iter().flatten().copied())
        .collect()
}

/// The shapes that may touch.
fn touching(model: &Model) -> Vec<ShapeId> {
    let pairs = model.contact_pairs.iter().map(|pair| pair.shapes);
    let named: HashSet<_> = pairs.flat_map(|(a, b)| [a, b]).collect();
    let ids = (0..model.shapes.len()).map(ShapeId);
    ids.filter(|id| model.shapes[id.0].collides || named.contains(id))
        .collect()
}

/// Those of them that are met by their corners: hulls, and meshes where a plane comes to them.
fn with_corners<'a>(
    model: &'a Model,
    touching: &'a [ShapeId],
) -> impl Iterator<Item = &'a Geometry> {
    let shapes = touching.iter().map(|id| &model.shapes[id.0]);
    let is_plane = |shape: &Shape| matches!(shape.geometry, Geometry::Plane { .. });
    let planes = Vec::from_iter(shapes.clone().filter(|shape| is_plane(shape)));
    let meets_plane = move |shape: &Shape| {
        planes
            .iter()
            .any(|plane| moves(model, plane) || moves(model, shape))
    };
    let has_corners = move |shape: &&Shape| match shape.geometry {
        Geometry::Hull(_) => true,
        Geometry::Mesh(_) => meets_plane(shape),
        _ => false,
    };
    shapes.filter(has_corners).map(|shape| &shape.geometry)
}

/// Whether a shape is on a body that moves.
fn moves(model: &Model, shape: &Shape) -> bool {
    let kind = shape.body.map(|id| model.bodies[id.0].kind);
    kind == Some(BodyKind::Dynamic)
}

fn colliders(
    model: &Model,
    touching: &[ShapeId],
    corners: &Corners,
    row_of: impl Fn(Option<BodyId>) -> u32,
) -> Result<Vec<Collider>, SolverError> {
    let collider = |&id: &ShapeId| {
        let shape = &model.shapes[id.0];
        let corners = corners.of(&shape.geometry);
        let row = row_of(shape.body);
        Ok(Collider {
            shape: id,
            row,
            kind: Solid::new(shape, NAME)?.kind,
            corners: corners.len(),
            first_corner: corners.start,
            sensor: shape.sensor,
        })
    };
    touching.iter().map(collider).collect()
}

/// Rows of the model's contact pairs, by colliders, the lower first.
fn paired(model: &Model, shapes: &[Collider]) -> HashMap<[u32; 2], usize> {
    let rows: HashMap<_, _> = shapes.iter().map(|s| s.shape).zip(0..).collect();
    let pairs = model.contact_pairs.iter().enumerate();
    pairs
        .map(|(i, pair)| {
            let (a, b) = (rows[&pair.shapes.0], rows[&pair.shapes.1]);
            ([a.min(b), a.max(b)], i)
        })
        .collect()
}

impl Free {
    fn new(model: &Model, id: JointId, joint: &Joint) -> Self {
        Self {
            joint: id,
            body: joint.child,
            parent_frame: joint.parent_frame,
            child_frame: joint.child_frame,
            coordinate: model.coordinate_range(id).start,
            dof: model.dof_range(id).start,
        }
    }
}
