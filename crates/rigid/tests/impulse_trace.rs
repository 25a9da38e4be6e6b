//! The kernels of `impulse` recorded: the record prints as valid WGSL, and run step by step it keeps
//! the bits of the kernel.

#[path = "../../collide/tests/shader/mod.rs"]
mod shader;

use kinetarium_rigid::impulse::joint::{self, Actuation, JointTables, ROWS, Sources, axis_link};
use kinetarium_rigid::impulse::pair::{ShapeTables, place};
use kinetarium_rigid::impulse::report::{
    BodyReport, ContactReport, FreeReport, ReportLengths, TieReport, tell_body, tell_contact,
    tell_free, tell_tie,
};
use kinetarium_rigid::impulse::sums::{SumTables, add};
use kinetarium_rigid::impulse::{
    BodyTables, ContactTables, POINTS, blow, body, contact, manifold, point, remembered,
};
use kinetarium_rigid::impulse::{global, mass, row};
use numbers::trace::{self, PrintOptions};
use numbers::{Cpu, Machine, Real, Shared};
use shader::validate;
use std::ops::RangeInclusive;

/// A kernel, over whatever machine.
trait Kernel {
    fn run<M: Machine>(&self, k: &mut M);
}

macro_rules! kernels {
    ($($name:ident($k:ident) = $body:expr;)+) => {
        $(struct $name;
        impl Kernel for $name {
            fn run<M: Machine>(&self, $k: &mut M) {
                $body
            }
        })+
    };
}

kernels! {
    Begin(k) = body::begin(k, &BodyTables::new());
    Advance(k) = body::advance(k, &BodyTables::new(), M::R::one());
    Shove(k) = body::push(k, &BodyTables::new());
    Part(k) = body::part(k, &BodyTables::new());
    Drift(k) = body::drift(k, &BodyTables::new());
    Finish(k) = body::finish(k, &BodyTables::new());
    Prepare(k) = contact::prepare(k, &ContactTables::new());
    WarmStart(k) = contact::warm_start(k, &ContactTables::new());
    Push(k) = contact::solve(k, &ContactTables::new(), M::R::one());
    Relax(k) = contact::solve(k, &ContactTables::new(), M::R::zero());
    Foresee(k) = blow::foresee(k, &ContactTables::new());
    Strike(k) = blow::strike(k, &ContactTables::new());
    AddPart(k) = add(k, &SumTables::new());
    StrikeForeseen(k) = blow::strike_foreseen(k, &ContactTables::new());
    Place(k) = place(k, &ShapeTables::new());
    Actuate(k) = joint::actuate(k, &Actuation::new(&SOURCES));
    Follow(k) = joint::follow(k, &JointTables::new());
    Stand(k) = joint::place(k, &JointTables::new());
    WarmJoint(k) = joint::warm_start(k, &JointTables::new());
    PushJoint(k) = joint::solve(k, &JointTables::new(), M::R::one());
    RelaxJoint(k) = joint::solve(k, &JointTables::new(), M::R::zero());
    StrikeJoint(k) = joint::strike(k, &JointTables::new());
    TellBody(k) = tell_body(k, &BodyReport::new());
    TellFree(k) = tell_free(k, &FreeReport::new());
    TellTie(k) = tell_tie(k, &TieReport::new());
    TellContact(k) = tell_contact(k, &ContactReport::new());
}

/// Rows with laws, with actuators, with both and with neither.
const SOURCES: Sources = Sources {
    laws: [1, 0, 3, 0, 2, 1],
    free: [0, 2, 1, 0, 0, 0],
};

/// The memories of one lane, full of numbers of any kind.
#[derive(Clone)]
struct Lane {
    state: Vec<f32>,
    input: Vec<f32>,
    output: Vec<f32>,
    scratch: Vec<f32>,
    parameters: Vec<f32>,
    links: Vec<u32>,
}

fn some(seed: u32) -> impl Iterator<Item = f32> {
    let mut x = seed;
    std::iter::from_fn(move || {
        x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        Some((x >> 8) as f32 / (1 << 24) as f32 + 0.01)
    })
}

impl Lane {
    fn new(seed: u32, points: u32) -> Self {
        let state = row::WIDTH.max(manifold::WIDTH + POINTS * point::WIDTH);
        Self::of(seed, state, vec![points])
    }
    /// With so many laws along each axis.
    fn joint(seed: u32, laws: u32) -> Self {
        let axis = |row: u32| [row % 2, laws * row, laws * (row + 1)];
        let links = (0..ROWS as u32).flat_map(axis).collect();
        assert_eq!(axis(0).len(), axis_link::WIDTH);
        Self::of(seed, JointTables::new().length, links)
    }
    fn of(seed: u32, state: usize, links: Vec<u32>) -> Self {
        let scratch = (2 * row::WIDTH).max(JointTables::SCRATCH);
        Self {
            state: some(seed).map(|x| x - 0.4).take(state).collect(),
            scratch: some(seed + 1).map(|x| x - 0.4).take(scratch).collect(),
            parameters: some(seed + 2)
                .take(global::WIDTH + mass::WIDTH + 32)
                .collect(),
            input: Vec::new(),
            output: Vec::new(),
            links,
        }
    }
    /// Of a joint with controls.
    fn actuated(seed: u32, _: u32) -> Self {
        let [given, constants, made] = Actuation::new(&SOURCES).lengths;
        let mut lane = Self::of(seed, 0, SOURCES.links().to_vec());
        lane.input = some(seed + 3).take(given).collect();
        lane.parameters = some(seed + 2).take(constants).collect();
        lane.output = vec![0.0; made];
        lane
    }
    /// That tells; of contacts, of a shape that does not move, and one that does.
    fn report(seed: u32, lengths: ReportLengths) -> Self {
        let mut lane = Self::of(seed, lengths.state, vec![7, 1, 9, 0]);
        lane.input = some(seed + 3).take(lengths.given).collect();
        lane.output = vec![0.0; lengths.told];
        lane
    }
    fn cpu(&mut self) -> Cpu<'_, f32, Shared<'_, f32>> {
        Cpu {
            state: &mut self.state,
            input: &self.input,
            output: &mut self.output,
            scratch: &mut self.scratch,
            parameters: Shared(&self.parameters),
            links: &self.links,
        }
    }
    fn bits(&self) -> Vec<u32> {
        let canonical = |x: &f32| if x.is_nan() { f32::NAN } else { *x }.to_bits();
        self.state
            .iter()
            .chain(&self.scratch)
            .chain(&self.output)
            .map(canonical)
            .collect()
    }
}

fn records_well(kernel: &impl Kernel) {
    records_well_in(kernel, Lane::new, 1..=POINTS as u32);
}

/// In lanes with so many points, or laws.
fn records_well_in(kernel: &impl Kernel, new: fn(u32, u32) -> Lane, counts: RangeInclusive<u32>) {
    let program = trace::record(|k| kernel.run(k)).unwrap();
    validate(&program, &PrintOptions::default());
    for count in counts {
        for seed in 0..20 {
            let mut lane = new(1000 * seed, count);
            let mut copy = lane.clone();
            kernel.run(&mut lane.cpu());
            program.interpret(&mut copy.cpu()).unwrap();
            assert_eq!(lane.bits(), copy.bits(), "seed {seed}, {count} of them");
        }
    }
}

#[test]
fn kernels_of_bodies_and_shapes_record_well() {
    records_well(&Begin);
    records_well(&Advance);
    records_well(&Shove);
    records_well(&Part);
    records_well(&Drift);
    records_well(&Finish);
    records_well(&Place);
}

#[test]
fn kernels_of_contacts_record_well() {
    records_well(&Prepare);
    records_well(&WarmStart);
    records_well(&Push);
    records_well(&Relax);
    records_well(&Foresee);
    records_well(&Strike);
    records_well(&StrikeForeseen);
    records_well(&AddPart);
}

#[test]
fn kernels_of_joints_record_well() {
    records_well_in(&Actuate, Lane::actuated, 0..=0);
    records_well_in(&Follow, Lane::joint, 0..=2);
    records_well_in(&Stand, Lane::joint, 0..=0);
    records_well_in(&WarmJoint, Lane::joint, 0..=0);
    records_well_in(&PushJoint, Lane::joint, 0..=3);
    records_well_in(&RelaxJoint, Lane::joint, 0..=0);
    records_well_in(&StrikeJoint, Lane::joint, 0..=0);
}

#[test]
fn kernels_that_tell_record_well() {
    let body = |seed, _| Lane::report(seed, BodyReport::new().lengths);
    let free = |seed, _| Lane::report(seed, FreeReport::new().lengths);
    let tie = |seed, _| Lane::report(seed, TieReport::new().lengths);
    records_well_in(&TellBody, body, 0..=0);
    records_well_in(&TellFree, free, 0..=0);
    records_well_in(&TellTie, tie, 0..=0);
    let contact = |seed, points: u32| {
        let mut lane = Lane::report(seed, ContactReport::new().lengths);
        lane.input[remembered::SHAPES] = (seed / 1000 % 2) as f32;
        lane.input[remembered::SHAPES + 1] = (seed / 2000 % 2) as f32;
        lane.input[remembered::POINTS] = points as f32;
        lane
    };
    records_well_in(&TellContact, contact, 1..=POINTS as u32);
}
