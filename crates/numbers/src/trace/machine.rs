//! The machine that records.

use super::graph::{Body, Graph, Handle, TraceError, apply};
use super::number::{Trace, TraceIndex, TraceMask};
use super::operation::Operation;
use super::program::{Action, Place, Program};
use crate::machine::space::{Space, Writable};
use crate::machine::{Cell, Links, Machine, Table};
use core::mem;
use core::panic::Location;

/// Records a kernel by running it once.
///
/// Fails where the kernel does something that a record cannot express; the
/// message names the line of the loop or branch concerned, and the remedy.
#[track_caller]
pub fn record(kernel: impl FnOnce(&mut Tracer<'_>)) -> Result<Program, TraceError> {
    let graph = Graph::new(Location::caller());
    kernel(&mut Tracer { graph: &graph });
    graph.finish()
}

/// The machine that records a kernel; see [`record`].
#[derive(Clone, Copy)]
pub struct Tracer<'g> {
    graph: &'g Graph,
}

impl<'g> Machine for Tracer<'g> {
    type R = Trace<'g>;
    type I = TraceIndex<'g>;
    type Flag = TraceMask<'g>;
    type Cell = TraceCell<'g>;
    type Rounds = TraceRounds<'g>;
    type Branch = TraceBranch<'g>;
    const HANDS_ON: bool = true;

    fn index(&self, i: usize) -> TraceIndex<'g> {
        TraceIndex::literal(i)
    }
    fn read<S: Space, const W: usize, const N: usize>(
        &self,
        table: Table<S, W>,
        row: TraceIndex<'g>,
        field: usize,
    ) -> [Trace<'g>; N] {
        std::array::from_fn(|i| {
            let place = Place::new(table.start(), field + i, W);
            Trace(Handle::Node(
                self.graph.emit(Action::Load(S::KIND, place), &[row.0]),
            ))
        })
    }
    fn write<S: Writable, const W: usize, const N: usize>(
        &mut self,
        table: Table<S, W>,
        row: TraceIndex<'g>,
        field: usize,
        x: [Trace<'g>; N],
    ) {
        for (i, x) in x.into_iter().enumerate() {
            let place = Place::new(table.start(), field + i, W);
            self.graph
                .emit(Action::Store(S::KIND, place), &[row.0, x.0]);
        }
    }
    fn link<const W: usize>(
        &self,
        links: Links<W>,
        row: TraceIndex<'g>,
        field: usize,
    ) -> TraceIndex<'g> {
        let place = Place::new(links.start(), field, W);
        TraceIndex(Handle::Node(self.graph.emit(Action::Link(place), &[row.0])))
    }
    fn link_row<const W: usize, const N: usize>(
        &self,
        links: Links<W>,
        row: TraceIndex<'g>,
    ) -> [TraceIndex<'g>; N] {
        std::array::from_fn(|field| self.link(links, row, field))
    }
    #[track_caller]
    fn range(&self, from: TraceIndex<'g>, to: TraceIndex<'g>) -> TraceRounds<'g> {
        TraceRounds::new(self.graph, from, to, false)
    }
    #[track_caller]
    fn range_down(&self, n: TraceIndex<'g>) -> TraceRounds<'g> {
        TraceRounds::new(self.graph, self.index(0), n, true)
    }
    #[track_caller]
    fn count(&self, n: usize) -> TraceRounds<'g> {
        self.range(self.index(0), self.index(n))
    }
    #[track_caller]
    fn when(&self, flag: TraceMask<'g>) -> Option<TraceBranch<'g>> {
        let head = Action::If { length: 0 };
        Some(TraceBranch(match flag.0 {
            Handle::Literal(0) => return None,
            // There is nothing to branch on.
            Handle::Literal(_) => None,
            condition => Some(self.graph.open(head, &[condition], Location::caller())),
        }))
    }
    #[track_caller]
    fn if_any(&self, mask: TraceMask<'g>) -> Option<TraceBranch<'g>> {
        self.when(mask)
    }
    #[track_caller]
    fn finished(&self, mask: TraceMask<'g>) -> bool {
        if !matches!(mask.0, Handle::Literal(0)) {
            self.graph.leave(mask.0, Location::caller());
        }
        false
    }
    fn equals(&self, a: TraceIndex<'g>, b: usize) -> TraceMask<'g> {
        TraceMask(apply(
            Operation::IndexEqual,
            &[a.0, TraceIndex::literal(b).0],
        ))
    }
    fn less(&self, a: TraceIndex<'g>, b: TraceIndex<'g>) -> TraceMask<'g> {
        TraceMask(apply(Operation::IndexLess, &[a.0, b.0]))
    }
    fn number(&self, i: TraceIndex<'g>) -> Trace<'g> {
        Trace(apply(Operation::Number, &[i.0]))
    }
    fn whole(&self, x: Trace<'g>) -> TraceIndex<'g> {
        TraceIndex(apply(Operation::Whole, &[x.0]))
    }
    fn cell(&self, x: Trace<'g>) -> TraceCell<'g> {
        let cell = Handle::Node(self.graph.emit(Action::Cell, &[x.0]));
        TraceCell {
            graph: self.graph,
            cell,
        }
    }
}

/// A recorded variable.
#[derive(Clone, Copy)]
pub struct TraceCell<'g> {
    graph: &'g Graph,
    cell: Handle<'g>,
}

impl<'g> Cell for TraceCell<'g> {
    type R = Trace<'g>;
    fn read(&self) -> Trace<'g> {
        Trace(Handle::Node(self.graph.emit(Action::Get, &[self.cell])))
    }
    fn write(&mut self, x: Trace<'g>) {
        self.graph.emit(Action::Set, &[self.cell, x.0]);
    }
}

/// A recorded loop: hands out the index twice, so that two rounds are compared.
pub struct TraceRounds<'g>(Loop<'g>);

enum Loop<'g> {
    Ready {
        graph: &'g Graph,
        bounds: [Handle<'g>; 2],
        down: bool,
        site: &'static Location<'static>,
    },
    First(Body<'g>),
    Second(Body<'g>),
    Done,
}

impl<'g> TraceRounds<'g> {
    #[track_caller]
    fn new(graph: &'g Graph, from: TraceIndex<'g>, to: TraceIndex<'g>, down: bool) -> Self {
        let site = Location::caller();
        Self(match [from.0, to.0] {
            [Handle::Literal(from), Handle::Literal(to)] if from >= to => Loop::Done,
            bounds => Loop::Ready {
                graph,
                bounds,
                down,
                site,
            },
        })
    }
}

impl<'g> Iterator for TraceRounds<'g> {
    type Item = TraceIndex<'g>;
    fn next(&mut self) -> Option<TraceIndex<'g>> {
        let (stage, index) = match mem::replace(&mut self.0, Loop::Done) {
            Loop::Ready {
                graph,
                bounds,
                down,
                site,
            } => {
                let body = graph.open(Action::Loop { down, length: 0 }, &bounds, site);
                let index = body.index();
                (Loop::First(body), index)
            }
            Loop::First(body) => {
                let body = body.again();
                let index = body.index();
                (Loop::Second(body), index)
            }
            Loop::Second(body) => {
                body.close();
                return None;
            }
            Loop::Done => return None,
        };
        self.0 = stage;
        Some(TraceIndex(index))
    }
}

/// A recorded branch, whose block ends when it is dropped.
pub struct TraceBranch<'g>(Option<Body<'g>>);

impl Drop for TraceBranch<'_> {
    fn drop(&mut self) {
        if let Some(body) = self.0.take() {
            body.close();
        }
    }
}
