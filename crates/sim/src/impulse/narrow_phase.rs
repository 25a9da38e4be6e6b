//! Where shapes that could touch do.

use super::sleep::NEARBY;
use crate::engine::Block;
use crate::jobs::{Lane, narrow_phase};
use collide::Route;
use numbers::{Float, Memory};
use rayon::prelude::*;
use rigid::impulse::pair::{Pair, PairTables, Placed, placed};
use rigid::impulse::{Cached, Collider, Impulse};
use std::collections::BTreeSet;

/// Kind and number of corners: what pairs have in common that are looked at side by side.
type Form = (usize, usize);

fn form(shape: &Collider) -> Form {
    (shape.kind, shape.corners)
}

/// Tables for each pair of forms that a model has.
#[derive(Debug)]
pub(super) struct NarrowPhase {
    /// Of each colliding shape the place of its form, lower kinds first.
    forms: Vec<usize>,
    /// For each form in turn those with each form; with lower ones none.
    tables: Vec<Option<PairTables>>,
    /// How many forms there are.
    count: usize,
}

/// What it works on.
pub(super) struct Scene<'a, T> {
    pub impulse: &'a Impulse,
    pub shapes: &'a [Placed<T>],
    pub parameters: &'a [T],
    pub lane: Lane,
    /// Pairs side by side.
    pub width: usize,
    /// Whether to use all threads of the pool.
    pub threads: bool,
}

/// A pair's place in the list of pairs, and its shapes, A first.
type Placing = (u32, [u32; 2]);

/// Pairs of the same forms.
struct Group<'a> {
    tables: &'a PairTables,
    pairs: Vec<Placing>,
}

impl NarrowPhase {
    pub fn new(impulse: &Impulse) -> Self {
        let shapes = impulse.shapes().iter();
        let forms = Vec::from_iter(shapes.clone().map(form).collect::<BTreeSet<_>>());
        let tables = |a: Form, b: Form| {
            let route = Route::of(a.0, b.0).filter(|_| a <= b)?;
            Some(PairTables::new(route, [a.0, b.0], [a.1, b.1]))
        };
        let pairs = forms.iter().flat_map(|a| forms.iter().map(|b| (*a, *b)));
        Self {
            tables: pairs.map(|(a, b)| tables(a, b)).collect(),
            forms: shapes
                .map(|shape| forms.partition_point(|f| *f < form(shape)))
                .collect(),
            count: forms.len(),
        }
    }

    /// The contacts of the pairs that have any, in the order of the pairs.
    pub fn find<T: Float>(
        &self,
        scene: &Scene<'_, T>,
        pairs: &[[u32; 2]],
        found: &mut Vec<Cached<T>>,
    ) {
        let groups = self.groups(scene, pairs);
        let results: Vec<Vec<(u32, Cached<T>)>> = if scene.threads {
            groups.par_iter().map(|group| scene.meet(group)).collect()
        } else {
            groups.iter().map(|group| scene.meet(group)).collect()
        };
        let all = results.iter().enumerate();
        let mut order: Vec<_> = all
            .flat_map(|(g, found)| found.iter().enumerate().map(move |(i, c)| (c.0, g, i)))
            .collect();
        order.sort_unstable_by_key(|(pair, ..)| *pair);
        found.clear();
        found.extend(order.into_iter().map(|(_, g, i)| results[g][i].1));
    }

    fn groups<T: Float>(&self, scene: &Scene<'_, T>, pairs: &[[u32; 2]]) -> Vec<Group<'_>> {
        let form = |shape: u32| self.forms[shape as usize];
        let mut open = vec![Vec::<Placing>::new(); self.tables.len()];
        let mut groups = Vec::new();
        for (i, &[a, b]) in pairs.iter().enumerate() {
            let [a, b] = if form(a) <= form(b) { [a, b] } else { [b, a] };
            let place = form(a) * self.count + form(b);
            let Some(tables) = &self.tables[place] else {
                continue;
            };
            let list = &mut open[place];
            list.push((i as u32, [a, b]));
            if list.len() == GROUP * scene.width {
                let pairs = std::mem::take(list);
                groups.push(Group { tables, pairs });
            }
        }
        for (pairs, tables) in open.into_iter().zip(&self.tables) {
            if let (false, Some(tables)) = (pairs.is_empty(), tables) {
                groups.push(Group { tables, pairs });
            }
        }
        groups
    }
}

/// Registers' worths of pairs that one thread takes at a time.
const GROUP: usize = 8;

impl<T: Float> Scene<'_, T> {
    fn meet(&self, group: &Group<'_>) -> Vec<(u32, Cached<T>)> {
        let [parameters, scratch] = group.tables.lengths();
        let width = self.width;
        let mut parameters = Memory::<T>::new(width, parameters, width);
        let mut scratch = Memory::<T>::new(width, scratch, width);
        let mut none = [(); 3].map(|()| Memory::<T>::new(width, 1, width));
        let mut found = Vec::with_capacity(group.pairs.len());
        for pairs in group.pairs.chunks(width) {
            for lane in 0..width {
                let (_, shapes) = pairs[lane.min(pairs.len() - 1)];
                let corners = |s: u32| self.impulse.corners_of(s as usize, self.parameters);
                let pair = Pair {
                    shapes: shapes.map(|s| &self.shapes[s as usize]),
                    corners: shapes.map(corners),
                    margin: self.impulse.margin(shapes, self.parameters),
                };
                let numbers = parameters.scalars_mut();
                group
                    .tables
                    .fill(lane, width, &pair, numbers, scratch.scalars_mut());
            }
            let [state, input, output] = &mut none;
            let mut block = Block {
                state: state.scalars_mut(),
                input: input.scalars(),
                output: output.scalars_mut(),
                scratch: scratch.scalars_mut(),
                parameters: parameters.scalars(),
                links: group.tables.links(),
            };
            narrow_phase(self.lane, group.tables.contacts(), &mut block);
            for (lane, (place, shapes)) in pairs.iter().enumerate() {
                let mut contact = Cached {
                    shapes: *shapes,
                    ..Cached::default()
                };
                let tables = group.tables;
                tables.read(lane, width, scratch.scalars(), &mut contact);
                if self.matters(&contact) {
                    found.push((*place, contact));
                }
            }
        }
        found
    }

    /// Whether any of a contact's points could close within the step.
    fn matters(&self, contact: &Cached<T>) -> bool {
        let [a, b] = contact.shapes.map(|s| &self.shapes[s as usize]);
        let reach = a.placed[placed::WAY] + b.placed[placed::WAY] + T::from_f64(NEARBY);
        contact.points[..contact.count]
            .iter()
            .any(|p| p.gap < reach)
    }
}
