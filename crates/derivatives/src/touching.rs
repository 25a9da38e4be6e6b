//! The parts of a step of bodies that touch, as functions of a size that compilers take well.
//!
//! Each is a module, as in `sim`'s jobs, so that they are compiled side by side.

use crate::jobs::registers_mut;
use collide::{Route, kernel};
use numbers::dispatch::{Isa, Job, run_registers};
use numbers::{Lanes, Machine};
use rigid::{ContactTables, Kernels, TouchingFeatherstone};
use std::any::Any;

/// A solver, and where its contacts lie.
pub(crate) type Solver<'a> = (&'a TouchingFeatherstone, &'a ContactTables);

macro_rules! half {
    ($(#[$doc:meta])* $name:ident) => {
        mod $name {
            use super::*;

            struct Work<'a> {
                kernels: &'a TouchingFeatherstone,
                memories: &'a mut dyn Any,
                stage: usize,
            }

            impl Job for Work<'_> {
                type Scalar = f64;
                type Output = ();
                const WIDEST: bool = false;
                #[inline(always)]
                fn run<R: Lanes<Scalar = f64>>(self) {
                    let memories = registers_mut::<R>(self.memories);
                    let cpu = &mut memories.cpu(self.kernels);
                    let stage = cpu.index(self.stage);
                    self.kernels.$name(cpu, stage);
                }
            }

            $(#[$doc])*
            pub(crate) fn $name(
                isa: Isa,
                kernels: &TouchingFeatherstone,
                memories: &mut dyn Any,
                stage: usize,
            ) {
                let work = Work { kernels, memories, stage };
                run_registers(isa, work);
            }
        }
        pub(crate) use $name::$name;
    };
}

half! {
    /// A stage up to the contacts.
    begin
}
half! {
    /// A stage from the contacts on.
    finish
}

macro_rules! pair_job {
    ($name:ident, |$contacts:ident, $cpu:ident| $meet:expr) => {
        mod $name {
            use super::*;

            struct Work<'a> {
                solver: Solver<'a>,
                memories: &'a mut dyn Any,
            }

            impl Job for Work<'_> {
                type Scalar = f64;
                type Output = ();
                const WIDEST: bool = false;
                #[inline(always)]
                fn run<R: Lanes<Scalar = f64>>(self) {
                    let (kernels, $contacts) = self.solver;
                    let memories = registers_mut::<R>(self.memories);
                    let $cpu = &mut memories.cpu(kernels);
                    $meet
                }
            }

            pub(super) fn run(isa: Isa, solver: Solver<'_>, memories: &mut dyn Any) {
                run_registers(isa, Work { solver, memories });
            }
        }
    };
}

macro_rules! pairs {
    ($($name:ident $kernel:ident;)+) => {
        $(pair_job!($name, |contacts, cpu| contacts.meet::<_, kernel::$kernel>(cpu));)+
        pair_job!(mesh, |contacts, cpu| contacts.meet_mesh(cpu));
        pair_job!(meshes, |contacts, cpu| contacts.meet_meshes(cpu));

        /// Fills the slots of the pairs of one kernel.
        pub(crate) fn meet(isa: Isa, solver: Solver<'_>, memories: &mut dyn Any, route: Route) {
            match route {
                $(Route::$kernel => $name::run(isa, solver, memories),)+
                Route::Mesh => mesh::run(isa, solver, memories),
                Route::Meshes => meshes::run(isa, solver, memories),
            }
        }
    };
}

collide::with_kernels!(pairs);
