//! Where shapes that could touch do.

use super::sleep::NEARBY;
use crate::engine::Block;
use crate::jobs::{Lane, narrow_phase};
use crate::meshes::Triangles;
use collide::mesh::Triangle;
use collide::{Route, kind};
use glam::{DMat3, DQuat, DVec3};
use numbers::{Float, Memory};
use rayon::prelude::*;
use rigid::impulse::pair::{Pair, PairTables, Placed, placed};
use rigid::impulse::{Cached, Collider, Impulse};
use space::Aabb;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

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
    /// Of shapes that are meshes.
    pub meshes: &'a [Option<Arc<Triangles>>],
    pub parameters: &'a [T],
    pub lane: Lane,
    /// Pairs side by side.
    pub width: usize,
    /// Whether to use all threads of the pool.
    pub threads: bool,
}

/// Two shapes that may touch.
struct Candidate<'a> {
    /// The place in the list of pairs.
    place: u32,
    /// A first.
    shapes: [u32; 2],
    /// Those of B that are near A, where B is a mesh.
    triangles: Vec<&'a Triangle>,
}

/// Pairs of the same forms, and of nearly as many triangles.
struct Group<'a> {
    tables: Cow<'a, PairTables>,
    pairs: Vec<Candidate<'a>>,
}

impl NarrowPhase {
    pub fn new(impulse: &Impulse) -> Self {
        let shapes = impulse.shapes().iter();
        let forms = Vec::from_iter(shapes.clone().map(form).collect::<BTreeSet<_>>());
        let tables = |a: Form, b: Form| {
            let route = Route::of(a.0, b.0).filter(|_| a <= b)?;
            // How many triangles are near is known in each step only.
            (route != Route::Mesh).then(|| PairTables::new(route, [a.0, b.0], [a.1, b.1]))
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
        order.sort_unstable();
        found.clear();
        found.extend(order.into_iter().map(|(_, g, i)| results[g][i].1));
    }

    fn groups<'a, T: Float>(
        &'a self,
        scene: &'a Scene<'_, T>,
        pairs: &[[u32; 2]],
    ) -> Vec<Group<'a>> {
        let form = |shape: u32| self.forms[shape as usize];
        let mut open: Vec<_> = self.tables.iter().map(|_| Vec::new()).collect();
        let mut groups = Vec::new();
        let mut with_mesh = Vec::new();
        for (place, &[a, b]) in (0..).zip(pairs) {
            let shapes = if form(a) <= form(b) { [a, b] } else { [b, a] };
            let row = form(shapes[0]) * self.count + form(shapes[1]);
            let Some(tables) = &self.tables[row] else {
                if scene.route(shapes) == Some(Route::Mesh) {
                    with_mesh.push((place, shapes));
                }
                continue;
            };
            let list = &mut open[row];
            list.push(Candidate {
                place,
                shapes,
                triangles: Vec::new(),
            });
            if list.len() == GROUP * scene.width {
                let pairs = std::mem::take(list);
                let tables = Cow::Borrowed(tables);
                groups.push(Group { tables, pairs });
            }
        }
        for (pairs, tables) in open.into_iter().zip(&self.tables) {
            if let (false, Some(tables)) = (pairs.is_empty(), tables) {
                let tables = Cow::Borrowed(tables);
                groups.push(Group { tables, pairs });
            }
        }
        groups.extend(scene.mesh_groups(&with_mesh));
        groups
    }
}

/// Registers' worths of pairs that one thread takes at a time.
const GROUP: usize = 8;
/// Share of a length that rounding of single precision may take away.
const ROUNDING: f64 = 1e-6;

impl<T: Float> Scene<'_, T> {
    fn route(&self, shapes: [u32; 2]) -> Option<Route> {
        let [a, b] = shapes.map(|s| self.impulse.shapes()[s as usize].kind);
        Route::of(a, b)
    }

    /// Pairs with meshes: side by side those of like solids with nearly as many triangles.
    fn mesh_groups(&self, pairs: &[(u32, [u32; 2])]) -> Vec<Group<'_>> {
        let find = |&(place, shapes): &(u32, [u32; 2])| Candidate {
            place,
            shapes,
            triangles: self.near(shapes),
        };
        let found: Vec<_> = if self.threads {
            pairs.par_iter().with_min_len(GROUP).map(find).collect()
        } else {
            pairs.iter().map(find).collect()
        };
        let mut alike = BTreeMap::<(Form, usize), Vec<Candidate<'_>>>::new();
        for pair in found.into_iter().filter(|pair| !pair.triangles.is_empty()) {
            let solid = form(&self.impulse.shapes()[pair.shapes[0] as usize]);
            let room = pair.triangles.len().next_power_of_two();
            alike.entry((solid, room)).or_default().push(pair);
        }
        let mut groups = Vec::new();
        for (((solid, corners), room), mut pairs) in alike {
            let kinds = [solid, kind::MESH];
            while !pairs.is_empty() {
                let rest = pairs.split_off(pairs.len().min(GROUP * self.width));
                groups.push(Group {
                    tables: Cow::Owned(PairTables::new(Route::Mesh, kinds, [corners, room])),
                    pairs: std::mem::replace(&mut pairs, rest),
                });
            }
        }
        groups
    }

    /// The triangles of the second shape that the first could reach within the step.
    fn near(&self, shapes: [u32; 2]) -> Vec<&Triangle> {
        let [a, b] = shapes.map(|s| &self.shapes[s as usize].placed);
        let Some(mesh) = &self.meshes[shapes[1] as usize] else {
            return Vec::new();
        };
        let vec3 = |of: &[T], at: usize| DVec3::from_array([0, 1, 2].map(|i| of[at + i].to_f64()));
        let turn = [0, 1, 2, 3].map(|i| b[placed::ORIENTATION + i].to_f64());
        let to_mesh = DMat3::from_quat(DQuat::from_array(turn)).transpose();
        let center = to_mesh * (vec3(a, placed::POSITION) - vec3(b, placed::POSITION));
        let margin = self.impulse.margin(shapes, self.parameters).to_f64();
        let reach = vec3(a, placed::EXTENT) + (b[placed::WAY].to_f64() + margin + NEARBY);
        let half = to_mesh.abs() * reach;
        let slack = ROUNDING * (center.abs() + half).max_element();
        mesh.near(&Aabb::enclosing(
            center - half - slack,
            center + half + slack,
        ))
    }

    fn meet(&self, group: &Group<'_>) -> Vec<(u32, Cached<T>)> {
        let [parameters, scratch] = group.tables.lengths();
        let width = self.width;
        let mut parameters = Memory::<T>::new(width, parameters, width);
        let mut scratch = Memory::<T>::new(width, scratch, width);
        let mut none = [(); 3].map(|()| Memory::<T>::new(width, 1, width));
        let mut found = Vec::with_capacity(group.pairs.len());
        let mut contacts = Vec::new();
        group.tables.begin(width, parameters.scalars_mut());
        for pairs in group.pairs.chunks(width) {
            for lane in 0..width {
                let Candidate {
                    shapes, triangles, ..
                } = &pairs[lane.min(pairs.len() - 1)];
                let corners = |s: u32| self.impulse.corners_of(s as usize, self.parameters);
                let pair = Pair {
                    shapes: shapes.map(|s| &self.shapes[s as usize]),
                    corners: shapes.map(corners),
                    // Lanes to spare repeat the last pair, far from its mesh.
                    triangles: if lane < pairs.len() { triangles } else { &[] },
                    margin: self.impulse.margin(*shapes, self.parameters),
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
                common: &[],
                links: group.tables.links(),
            };
            narrow_phase(self.lane, group.tables.contacts(), &mut block);
            for (lane, pair) in pairs.iter().enumerate() {
                let scratch = scratch.scalars();
                group
                    .tables
                    .read(lane, width, scratch, pair.shapes, &mut contacts);
                let contacts = contacts.drain(..).filter(|contact| self.matters(contact));
                found.extend(contacts.map(|contact| (pair.place, contact)));
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
