//! The work on one block, as functions of a size that compilers take well.
//!
//! Whoever uses a generic function compiles it, and all that one module uses is compiled together.
//! Hence a module for each part of a step at each precision, and for each kernel of a pair: they
//! compile side by side.

use crate::engine::Block;
use collide::{Route, kernel};
use numbers::dispatch::{Isa, Job, run_lanes, run_widest};
use numbers::{Cpu, Float, Lanes, Machine, Parameters, PerWorld, Shared};
use rigid::{ContactTables, Instrument, Kernels};

/// What a block's numbers are read as.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lane {
    pub isa: Isa,
    /// One world, or as many as a register has lanes.
    pub single: bool,
}

impl Lane {
    #[inline(always)]
    pub(crate) fn run<J: Job<Output = ()>>(self, job: J) {
        run_lanes(self.isa, self.single, job);
    }
}

impl<T: Float> Block<'_, T> {
    /// Its memories, read as registers.
    #[inline(always)]
    fn cpu<R: Lanes<Scalar = T>>(&mut self) -> Cpu<'_, R, PerWorld<'_, R>> {
        let parameters = PerWorld(bytemuck::cast_slice(self.parameters));
        self.cpu_with(parameters)
    }
    /// The same, with the constants that all worlds have in common: a sixteenth of the numbers, so that they
    /// stay in the nearest cache.
    #[inline(always)]
    fn cpu_in_common<R: Lanes<Scalar = T>>(&mut self) -> Cpu<'_, R, Shared<'_, R>> {
        let parameters = Shared(self.common);
        self.cpu_with(parameters)
    }
    #[inline(always)]
    fn cpu_with<R: Lanes<Scalar = T>, P: Parameters<R>>(&mut self, parameters: P) -> Cpu<'_, R, P> {
        Cpu {
            state: bytemuck::cast_slice_mut(self.state),
            input: bytemuck::cast_slice(self.input),
            output: bytemuck::cast_slice_mut(self.output),
            scratch: bytemuck::cast_slice_mut(self.scratch),
            parameters,
            links: self.links,
        }
    }
}

/// A job of a solver, in a module of its own: `body` with the solver, a machine, and a number; and
/// whether it takes so much of the time that all registers of AVX-512 are worth their while.
macro_rules! job {
    ($(#[$doc:meta])* $name:ident($kernels:ident, $cpu:ident, $number:ident), $registers:literal, $body:block) => {
        $(#[$doc])*
        pub(crate) mod $name {
            use super::*;

            struct Work<'a, 'b, K, T, const IN_COMMON: bool> {
                kernels: &'a K,
                block: &'a mut Block<'b, T>,
                number: usize,
            }

            impl<K: Kernels, T: Float, const IN_COMMON: bool> Job for Work<'_, '_, K, T, IN_COMMON> {
                type Scalar = T;
                type Output = ();
                const MANY_REGISTERS: bool = K::MANY_REGISTERS && $registers;
                const WIDEST: bool = $registers;
                #[inline(always)]
                fn run<R: Lanes<Scalar = T>>(self) {
                    let ($kernels, $number) = (self.kernels, self.number);
                    if IN_COMMON {
                        let $cpu = &mut self.block.cpu_in_common::<R>();
                        $body
                    } else {
                        let $cpu = &mut self.block.cpu::<R>();
                        $body
                    }
                }
            }

            pub(crate) fn run<K: Kernels, T: Float>(
                lane: Lane,
                kernels: &K,
                block: &mut Block<'_, T>,
                number: usize,
            ) {
                if T::DOUBLE {
                    return double::run(lane, Work { kernels, block, number });
                }
                let mut block = block;
                let widest = $registers && K::MANY_REGISTERS && !lane.single;
                if widest && !block.common.is_empty() {
                    match in_common::run(lane, Work { kernels, block, number }) {
                        Ok(()) => return,
                        Err(left) => block = left.block,
                    }
                }
                // In one place, as what this calls is compiled into it.
                single::run(lane, Work { kernels, block, number });
            }

            mod single {
                use super::*;
                pub(super) fn run<K: Kernels, T: Float>(lane: Lane, work: Work<'_, '_, K, T, false>) {
                    lane.run(work);
                }
            }

            mod in_common {
                use super::*;
                pub(super) fn run<'a, 'b, K: Kernels, T: Float>(
                    lane: Lane,
                    work: Work<'a, 'b, K, T, true>,
                ) -> Result<(), Work<'a, 'b, K, T, true>> {
                    run_widest(lane.isa, work)
                }
            }

            mod double {
                use super::*;
                pub(super) fn run<K: Kernels, T: Float>(lane: Lane, work: Work<'_, '_, K, T, false>) {
                    lane.run(work);
                }
            }
        }
    };
}

job! {
    /// So many whole substeps.
    steps(kernels, cpu, substeps), true, {
        for _ in 0..substeps {
            kernels.step(cpu);
        }
    }
}
job! {
    /// A stage up to the contacts.
    begin(kernels, cpu, stage), true, {
        let stage = cpu.index(stage);
        kernels.begin(cpu, stage);
    }
}
job! {
    /// A stage from the contacts on.
    finish(kernels, cpu, stage), true, {
        let stage = cpu.index(stage);
        kernels.finish(cpu, stage);
    }
}
job! {
    /// Where joints are, and how they move, from the state.
    joints(kernels, cpu, _none), false, { kernels.report_joints(cpu) }
}
job! {
    /// The same of bodies, too.
    motion(kernels, cpu, _none), true, { kernels.report_motion(cpu) }
}
job! {
    /// The same, and the contacts of the last step.
    contacts(kernels, cpu, _none), true, { kernels.report_contacts(cpu) }
}
job! {
    /// The output from the state.
    report(kernels, cpu, _none), true, { kernels.report(cpu) }
}

/// Reads an instrument, where a block's state is what its worlds are told, its input what they have reported, and its output
/// the numbers read.
pub(crate) fn measure<T: Float>(lane: Lane, instrument: &Instrument, block: &mut Block<'_, T>) {
    match instrument {
        Instrument::Rangefinder(finder) => ranges::run(lane, finder, block),
        Instrument::Gauges(list) => gauges::run(lane, list, block),
    }
}

/// The job of an instrument, in a module of its own.
macro_rules! instrument {
    ($name:ident $instrument:ident) => {
        pub(crate) mod $name {
            use super::*;
            use rigid::$instrument;

            struct Work<'a, 'b, T, const IN_COMMON: bool> {
                instrument: &'a $instrument,
                block: &'a mut Block<'b, T>,
            }

            impl<T: Float, const IN_COMMON: bool> Job for Work<'_, '_, T, IN_COMMON> {
                type Scalar = T;
                type Output = ();
                const WIDEST: bool = !T::DOUBLE;
                #[inline(always)]
                fn run<R: Lanes<Scalar = T>>(self) {
                    if IN_COMMON {
                        self.instrument
                            .measure(&mut self.block.cpu_in_common::<R>());
                    } else {
                        self.instrument.measure(&mut self.block.cpu::<R>());
                    }
                }
            }

            pub(crate) fn run<T: Float>(
                lane: Lane,
                instrument: &$instrument,
                block: &mut Block<'_, T>,
            ) {
                if block.common.is_empty() {
                    lane.run(Work::<T, false> { instrument, block });
                } else {
                    lane.run(Work::<T, true> { instrument, block });
                }
            }
        }
    };
}

instrument!(ranges Rangefinder);
instrument!(gauges Gauges);

/// Fills the slots of contacts, kernel by kernel.
pub(crate) fn narrow_phase<T: Float>(
    lane: Lane,
    contacts: &ContactTables,
    block: &mut Block<'_, T>,
) {
    for route in contacts.routes() {
        meet(lane, contacts, block, route);
    }
}

/// A job that fills the slots of some pairs, in a module of its own; and whether it is compiled for
/// AVX-512.
macro_rules! pair_job {
    ($name:ident, $widest:expr, |$contacts:ident, $cpu:ident| $meet:expr) => {
        mod $name {
            use super::*;

            struct Work<'a, 'b, T> {
                contacts: &'a ContactTables,
                block: &'a mut Block<'b, T>,
            }

            impl<T: Float> Job for Work<'_, '_, T> {
                type Scalar = T;
                type Output = ();
                const WIDEST: bool = $widest;
                #[inline(always)]
                fn run<R: Lanes<Scalar = T>>(self) {
                    let ($contacts, $cpu) = (self.contacts, &mut self.block.cpu::<R>());
                    $meet
                }
            }

            pub(super) fn run<T: Float>(
                lane: Lane,
                contacts: &ContactTables,
                block: &mut Block<'_, T>,
            ) {
                lane.run(Work { contacts, block });
            }
        }
    };
}

/// The kernels for pairs.
macro_rules! pairs {
    ($($name:ident $kernel:ident;)+) => {
        $(pair_job!($name, !T::DOUBLE, |contacts, cpu| contacts.meet::<_, kernel::$kernel>(cpu));)+
        pair_job!(mesh, !T::DOUBLE, |contacts, cpu| contacts.meet_mesh(cpu));
        pair_job!(meshes, false, |contacts, cpu| contacts.meet_meshes(cpu));
        pair_job!(bounds, !T::DOUBLE, |contacts, cpu| contacts.apart(cpu));

        /// How far the shapes of the first pair are apart at least, into the first slot.
        pub(crate) fn apart<T: Float>(lane: Lane, contacts: &ContactTables, block: &mut Block<'_, T>) {
            bounds::run(lane, contacts, block);
        }

        /// The pairs of one kernel.
        fn meet<T: Float>(
            lane: Lane,
            contacts: &ContactTables,
            block: &mut Block<'_, T>,
            route: Route,
        ) {
            match route {
                $(Route::$kernel => $name::run(lane, contacts, block),)+
                Route::Mesh => mesh::run(lane, contacts, block),
                Route::Meshes => meshes::run(lane, contacts, block),
            }
        }
    };
}

collide::with_kernels!(pairs);
