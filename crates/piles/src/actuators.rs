//! What controls make of the forces along joints' axes, on a card.
//!
//! The host brings controls to lanes, `[number][joint]`; the kernel of the processor
//! (`rigid/src/impulse/joint/actuation`) makes forces of them when they have changed.

use crate::Card;
use crate::card::{BINDINGS, Commands, WORKGROUP, filled, sized};
use crate::joints::Joints;
use crate::plan::Plan;
use crate::scene::Scene;
use crate::uniform::Uniform;
use numbers::trace::Members;
use sim::DeviceError;

/// The kernel, and where it works. A lane is a joint of a world: the same one of all worlds lies side by side.
#[derive(Debug)]
pub(crate) struct Actuators<C: Card> {
    kernel: C::Kernel,
    bindings: C::Bindings,
    controls: C::Buffer,
    constants: C::Buffer,
    made: C::Buffer,
    launch: Uniform<C, 2>,
    /// The first of the worlds of which these constants are, where worlds have their own, else 0.
    of: Option<usize>,
}

impl<C: Card> Actuators<C> {
    pub fn new(card: &C, scene: &Scene, joints: &Joints) -> Result<Self, DeviceError> {
        let lanes = scene.plan.joints as usize;
        let lengths = joints.actuation().lengths;
        let [controls, constants, made] = lengths.map(|n| sized(card, (n * lanes) as u64));
        let (controls, constants, made) = (controls?, constants?, made?);
        let launch = Uniform::new(card)?;
        let [no_state, no_scratch] = [card.buffer(1)?, card.buffer(1)?];
        let links = filled(card, &joints.sources.links())?;
        let bindings: [&C::Buffer; BINDINGS] = [
            &no_state,
            &controls,
            &made,
            &no_scratch,
            &constants,
            &links,
            &launch.buffer,
        ];
        Ok(Self {
            kernel: card.kernel(&joints.programs.actuate, true, Members::Worlds)?,
            bindings: card.bind_kernel(bindings),
            controls,
            constants,
            made,
            launch,
            of: None,
        })
    }
    /// Constants have changed.
    pub fn differs(&mut self) {
        self.of = None;
    }

    /// Makes forces of the controls of some worlds, and puts them behind their states.
    pub fn act(
        &mut self,
        card: &C,
        scene: &Scene,
        joints: &Joints,
        (first, inputs): (usize, &[Vec<f32>]),
        state: &C::Buffer,
    ) -> Result<(), DeviceError> {
        let (impulse, plan, sources) = (&scene.impulse, &scene.plan, &joints.sources);
        let [given, constants, made] = joints.actuation().lengths;
        let of = if scene.parameters.differ() { first } else { 0 };
        if self.of != Some(of) {
            let numbers = columns(joints, plan, constants, |nth, tie, own| {
                let parameters = scene.parameters.of(first + nth);
                let tied = impulse.tied_constants(tie, parameters);
                let put = |x| own.push(x as f32);
                impulse.actuation_constants((tie, &tied), sources, parameters, put);
            });
            card.write(&self.constants, 0, bytemuck::cast_slice(&numbers))?;
            self.of = Some(of);
        }
        let controls = columns(joints, plan, given, |nth, tie, own| {
            if let Some(input) = inputs.get(nth) {
                impulse.actuation_controls(tie, sources, input, |x| own.push(x as f32));
            }
        });
        card.write(&self.controls, 0, bytemuck::cast_slice(&controls))?;
        self.launch.set(card, [plan.joints as usize, 1])?;
        let mut todo = card.commands(None);
        let groups = plan.joints.div_ceil(WORKGROUP);
        todo.run(&self.kernel, &self.bindings, groups);
        let words = 0..made * plan.joints as usize;
        todo.copy(&self.made, words, state, plan.acting as usize);
        card.submit(todo)
    }
}

/// So many numbers of each joint of each world of a batch, `[number][joint]`: given which world, and the joint, some of
/// them, the others zero.
fn columns(
    joints: &Joints,
    plan: &Plan,
    numbers: usize,
    of: impl Fn(usize, usize, &mut Vec<f32>),
) -> Vec<f32> {
    let lanes = plan.joints as usize;
    let mut columns = vec![0.0; numbers * lanes];
    let mut own = Vec::with_capacity(numbers);
    let all = joints
        .ties
        .iter()
        .flat_map(|tie| (0..plan.worlds as usize).map(move |nth| (nth, *tie)));
    for (lane, (nth, tie)) in all.enumerate() {
        own.clear();
        of(nth, tie as usize, &mut own);
        for (number, x) in own.iter().enumerate() {
            columns[number * lanes + lane] = *x;
        }
    }
    columns
}
