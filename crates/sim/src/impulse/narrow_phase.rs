//! Where shapes that could touch do.

use super::broad_phase::{Candidate, reach};
use super::mid_phase::{MeshPair, MidPhase};
use crate::engine::Block;
use crate::jobs::{Lane, apart, narrow_phase};
use crate::meshes::Triangles;
use collide::{Route, kind};
use glam::DVec3;
use numbers::{Float, Memory};
use rayon::prelude::*;
use rigid::impulse::NEARBY;
use rigid::impulse::pair::{MARGIN, Near, Pair, PairTables, Placed, placed};
use rigid::impulse::{Cached, Collider, Impulse};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, PoisonError};

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
    /// What the shapes' odometers show [m].
    pub ways: &'a [f64],
    /// The world's, with the contacts of the step before.
    pub state: &'a [T],
    pub parameters: &'a [T],
    pub lane: Lane,
    /// Pairs side by side.
    pub width: usize,
    /// Whether to use all threads of the pool.
    pub threads: bool,
}

/// A pair as it is looked at.
struct Look<T> {
    /// The place in the list of pairs.
    place: u32,
    /// A first.
    shapes: [u32; 2],
    /// The direction from A to B in which they touched in the step before; zero where they did not.
    known: [T; 3],
}

impl<T: Float> Look<T> {
    /// Whether they touched in the step before.
    fn touched(&self) -> bool {
        self.known != [T::zero(); 3]
    }
}

/// Pairs of the same forms, and of nearly as many triangles.
struct Group<'a, T> {
    tables: Cow<'a, PairTables>,
    pairs: Vec<Look<T>>,
    /// Of each pair, where a mesh is among them.
    triangles: Vec<[Near<'a>; 2]>,
}

/// What was found of a group's pairs, by their places in the list of pairs.
struct Found<T> {
    contacts: Vec<Cached<T>>,
    /// Of each contact, the place of its pair.
    places: Vec<u32>,
    /// Pairs that are apart [m].
    apart: Vec<(u32, f64)>,
}

impl NarrowPhase {
    pub fn new(impulse: &Impulse) -> Self {
        let shapes = impulse.shapes().iter();
        let forms = Vec::from_iter(shapes.clone().map(form).collect::<BTreeSet<_>>());
        let tables = |a: Form, b: Form| {
            let route = Route::of(a.0, b.0).filter(|_| a <= b)?;
            // How many triangles are near is known in each step only.
            let known = !matches!(route, Route::Mesh | Route::Meshes);
            known.then(|| PairTables::new(route, [a.0, b.0], [a.1, b.1]))
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

    /// The contacts of the pairs that have any, in the order of the pairs; which pairs are apart, and by which length
    /// [m] at least.
    pub fn find<T: Float>(
        &self,
        scene: &Scene<'_, T>,
        pairs: &[Candidate],
        mid_phase: &mut MidPhase,
        contacts: &mut Vec<Cached<T>>,
    ) -> Vec<(Candidate, f64)> {
        let results = Mutex::new(Vec::new());
        let meet = |group: &Group<'_, T>| {
            let found = scene.meet(group);
            let mut results = results.lock().unwrap_or_else(PoisonError::into_inner);
            results.push(found);
        };
        let without = if scene.threads {
            rayon::scope(|team| {
                let meet = |group| team.spawn(|_| meet(&{ group }));
                self.group(scene, pairs, mid_phase, meet)
            })
        } else {
            self.group(scene, pairs, mid_phase, |group| meet(&group))
        };
        let results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
        let apart = results.iter().flat_map(|found| &found.apart);
        let apart = apart.chain(&without);
        let apart = apart.map(|(place, gap)| (pairs[*place as usize], *gap));
        let apart = apart.collect();
        let order = in_order(&results, pairs.len());
        let contact = |[group, i]: [u32; 2]| results[group as usize].contacts[i as usize];
        if scene.threads {
            let order = order.into_par_iter().with_min_len(GROUP);
            order.map(contact).collect_into_vec(contacts);
        } else {
            contacts.clear();
            contacts.extend(order.into_iter().map(contact));
        }
        apart
    }

    /// Sorts pairs into groups; each is to be met as soon as it is full. Returns the places of those that are found
    /// to be apart already, and by which length [m] they are.
    fn group<'a, T: Float>(
        &'a self,
        scene: &'a Scene<'_, T>,
        pairs: &[Candidate],
        mid_phase: &'a mut MidPhase,
        mut meet: impl FnMut(Group<'a, T>),
    ) -> Vec<(u32, f64)> {
        let form = |shape: u32| self.forms[shape as usize];
        let mut open: Vec<_> = self.tables.iter().map(|_| Vec::new()).collect();
        let mut with_mesh = Vec::new();
        let mut before = Before {
            impulse: scene.impulse,
            state: scene.state,
            next: 0,
        };
        for (place, pair) in (0..).zip(pairs) {
            let [a, b] = pair.shapes;
            let shapes = if form(a) <= form(b) { [a, b] } else { [b, a] };
            let row = form(shapes[0]) * self.count + form(shapes[1]);
            let Some(tables) = &self.tables[row] else {
                if scene.route(shapes).is_some() {
                    with_mesh.push((place, shapes));
                }
                continue;
            };
            let list = &mut open[row];
            list.push(Look {
                place,
                shapes,
                known: before.direction(shapes),
            });
            if list.len() == GROUP * scene.width {
                meet(Group::of_solids(tables, std::mem::take(list)));
            }
        }
        for (pairs, tables) in open.into_iter().zip(&self.tables) {
            if let (false, Some(tables)) = (pairs.is_empty(), tables) {
                meet(Group::of_solids(tables, pairs));
            }
        }
        let kept = mid_phase.find(scene, with_mesh.iter().map(|(_, shapes)| *shapes), GROUP);
        let places = with_mesh.iter().map(|(place, _)| *place);
        let (near, far): (Vec<_>, Vec<_>) = places.zip(kept).partition(|(_, kept)| kept.is_near());
        scene.mesh_groups(&near).into_iter().for_each(meet);
        let gap = |kept: &MeshPair| kept.gap(scene.gone(kept.shapes));
        far.into_iter()
            .map(|(place, kept)| (place, gap(kept)))
            .collect()
    }
}

/// Where the contacts were found, group and place in it, in the order of their pairs.
fn in_order<T>(results: &[Found<T>], pairs: usize) -> Vec<[u32; 2]> {
    let all = || (0..).zip(results.iter().map(|found| (0..).zip(&found.places)));
    // A counting sort: where those of each pair begin.
    let mut next = vec![0_u32; pairs + 1];
    for (_, places) in all() {
        places.for_each(|(_, place)| next[*place as usize + 1] += 1);
    }
    for pair in 0..pairs {
        next[pair + 1] += next[pair];
    }
    let mut order = vec![[0; 2]; next[pairs] as usize];
    for (group, places) in all() {
        for (i, place) in places {
            let next = &mut next[*place as usize];
            order[*next as usize] = [group, i];
            *next += 1;
        }
    }
    order
}

impl<'a, T> Group<'a, T> {
    fn of_solids(tables: &'a PairTables, pairs: Vec<Look<T>>) -> Self {
        let tables = Cow::Borrowed(tables);
        let triangles = Vec::new();
        Self {
            tables,
            pairs,
            triangles,
        }
    }
}

/// Registers' worths of pairs that one thread takes at a time.
const GROUP: usize = 16;
/// Share of a length that rounding of single precision may take away.
pub(super) const ROUNDING: f64 = 1e-6;

impl<T: Float> Scene<'_, T> {
    fn route(&self, shapes: [u32; 2]) -> Option<Route> {
        let [a, b] = shapes.map(|s| self.impulse.shapes()[s as usize].kind);
        Route::of(a, b)
    }

    /// Pairs with meshes: side by side those of like solids, or of meshes, with nearly as many triangles.
    fn mesh_groups<'a>(&'a self, pairs: &[(u32, &'a MeshPair)]) -> Vec<Group<'a, T>> {
        let mut alike = BTreeMap::<(Form, usize), (Vec<Look<T>>, Vec<[Near<'a>; 2]>)>::new();
        for &(place, MeshPair { shapes, near, .. }) in pairs {
            let mut first = form(&self.impulse.shapes()[shapes[0] as usize]);
            let [of_a, of_b] = [0, 1].map(|i| near[i].len().next_power_of_two());
            if first.0 == kind::MESH {
                first.1 = of_a;
            }
            let (looks, triangles) = alike.entry((first, of_b)).or_default();
            looks.push(Look {
                place,
                shapes: *shapes,
                known: [T::zero(); 3],
            });
            triangles.push([0, 1].map(|i| match &self.meshes[shapes[i] as usize] {
                Some(mesh) => mesh.some(&near[i]),
                None => Near::default(),
            }));
        }
        let mut groups = Vec::new();
        for (((first, size), room), (mut pairs, mut triangles)) in alike {
            let kinds = [first, kind::MESH];
            let route = Route::of(first, kind::MESH).expect("there is one");
            while !pairs.is_empty() {
                let most = pairs.len().min(GROUP * self.width);
                let (more, others) = (pairs.split_off(most), triangles.split_off(most));
                groups.push(Group {
                    tables: Cow::Owned(PairTables::new(route, kinds, [size, room])),
                    pairs: std::mem::replace(&mut pairs, more),
                    triangles: std::mem::replace(&mut triangles, others),
                });
            }
        }
        groups
    }

    /// The contacts of a group: of the pairs that are near, once those are known where that is found out sooner.
    fn meet(&self, group: &Group<'_, T>) -> Found<T> {
        let mut register = Register::new(self.width, group);
        let mut found = Found {
            contacts: Vec::with_capacity(group.pairs.len()),
            places: Vec::with_capacity(group.pairs.len()),
            apart: Vec::new(),
        };
        let old = |i: &u32| !group.tables.takes_long() || group.pairs[*i as usize].touched();
        let (mut near, new): (Vec<_>, Vec<_>) = (0..group.pairs.len() as u32).partition(old);
        for members in new.chunks(self.width) {
            register.fill(self, members);
            register.run(|block| apart(self.lane, group.tables.contacts(), block));
            for (lane, member) in members.iter().enumerate() {
                let pair = &group.pairs[*member as usize];
                let gap = register.apart(lane).to_f64();
                if gap < reach(self.shapes, pair.shapes) {
                    near.push(*member);
                } else {
                    found
                        .apart
                        .push((pair.place, self.surely(gap, pair.shapes)));
                }
            }
        }
        for members in near.chunks(self.width) {
            register.fill(self, members);
            register.run(|block| narrow_phase(self.lane, group.tables.contacts(), block));
            for (lane, member) in members.iter().enumerate() {
                let pair = &group.pairs[*member as usize];
                let first = found.contacts.len();
                register.read(lane, pair.shapes, &mut found.contacts);
                if found.contacts.len() == first && group.triangles.is_empty() {
                    let gap = self.unseen(pair.shapes);
                    found
                        .apart
                        .push((pair.place, self.surely(gap, pair.shapes)));
                }
                let idle = |contact: &mut Cached<T>| !self.matters(contact);
                found.contacts.extract_if(first.., idle).for_each(drop);
                found.places.resize(found.contacts.len(), pair.place);
            }
        }
        found
    }

    /// How far [m] two shapes are apart at least that the kernels found no contact of: they look as far as the
    /// shapes get within the step, and a margin; and they are no nearer than the balls about them.
    fn unseen(&self, shapes: [u32; 2]) -> f64 {
        let [a, b] = shapes.map(|s| self.shapes[s as usize].placed);
        let looked = reach(self.shapes, shapes) - NEARBY + 0.5 * MARGIN;
        let margin = self.impulse.margin(shapes, self.parameters).to_f64();
        let radius = |placed: &[T]| (placed[placed::REACH] - placed[placed::WAY]).to_f64();
        let apart = (vec3(&b, placed::POSITION) - vec3(&a, placed::POSITION)).length();
        let has_plane = shapes
            .iter()
            .any(|s| self.impulse.shapes()[*s as usize].kind == kind::PLANE);
        if has_plane {
            looked
        } else {
            looked.max(apart - radius(&a) - radius(&b) - margin)
        }
    }

    /// A gap [m] less what rounding may have added to it.
    fn surely(&self, gap: f64, shapes: [u32; 2]) -> f64 {
        let half = |s: u32| vec3(&self.shapes[s as usize].placed, placed::EXTENT).max_element();
        let size = gap + half(shapes[0]) + half(shapes[1]);
        gap - 0.1 * NEARBY - ROUNDING * size
    }

    /// Whether any of a contact's points could close within the step.
    fn matters(&self, contact: &Cached<T>) -> bool {
        let reach = T::from_f64(reach(self.shapes, contact.shapes));
        contact.points[..contact.count]
            .iter()
            .any(|p| p.gap < reach)
    }
}

pub(super) fn vec3<T: Float>(numbers: &[T], at: usize) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|i| numbers[at + i].to_f64()))
}

/// Pairs of the same forms side by side.
struct Register<'a, T> {
    group: &'a Group<'a, T>,
    width: usize,
    parameters: Memory<T>,
    scratch: Memory<T>,
    /// What the kernels for pairs do not use.
    none: [Memory<T>; 3],
}

impl<'a, T: Float> Register<'a, T> {
    fn new(width: usize, group: &'a Group<'a, T>) -> Self {
        let memory = |length| Memory::<T>::new(width, length, width);
        let [mut parameters, scratch] = group.tables.lengths().map(memory);
        group.tables.begin(width, parameters.scalars_mut());
        Self {
            group,
            width,
            parameters,
            scratch,
            none: [1; 3].map(memory),
        }
    }

    /// Writes members of the group into the lanes; those to spare repeat the last, far from its mesh.
    fn fill(&mut self, scene: &Scene<'_, T>, members: &[u32]) {
        for lane in 0..self.width {
            let member = members.get(lane).or(members.last()).expect("there is one");
            let near = self.group.triangles.get(*member as usize);
            let triangles = match near {
                Some(near) if lane < members.len() => *near,
                _ => [Near::default(); 2],
            };
            self.fill_lane(scene, lane, *member, triangles);
        }
    }

    fn fill_lane(
        &mut self,
        scene: &Scene<'_, T>,
        lane: usize,
        member: u32,
        triangles: [Near<'_>; 2],
    ) {
        let look = &self.group.pairs[member as usize];
        let corners = |s: u32| scene.impulse.corners_of(s as usize, scene.parameters);
        let pair = Pair {
            shapes: look.shapes.map(|s| &scene.shapes[s as usize]),
            corners: look.shapes.map(corners),
            triangles,
            known: look.known,
            margin: scene.impulse.margin(look.shapes, scene.parameters),
        };
        let (parameters, scratch) = (self.parameters.scalars_mut(), self.scratch.scalars_mut());
        let tables = &self.group.tables;
        tables.fill(lane, self.width, &pair, parameters, scratch);
    }

    fn run(&mut self, work: impl FnOnce(&mut Block<'_, T>)) {
        let [state, input, output] = &mut self.none;
        work(&mut Block {
            number: 0,
            state: state.scalars_mut(),
            input: input.scalars(),
            output: output.scalars_mut(),
            scratch: self.scratch.scalars_mut(),
            parameters: self.parameters.scalars(),
            common: &[],
            links: self.group.tables.links(),
        });
    }

    /// How far a lane's pair is apart at least [m].
    fn apart(&self, lane: usize) -> T {
        let scratch = self.scratch.scalars();
        self.group.tables.apart(lane, self.width, scratch)
    }

    /// The contacts of a lane's pair.
    fn read(&self, lane: usize, shapes: [u32; 2], to: &mut Vec<Cached<T>>) {
        let scratch = self.scratch.scalars();
        self.group
            .tables
            .read(lane, self.width, scratch, shapes, to);
    }
}

/// The contacts of the step before, in the order of their pairs.
struct Before<'a, T> {
    impulse: &'a Impulse,
    state: &'a [T],
    next: usize,
}

impl<T: Float> Before<'_, T> {
    /// The direction in which two shapes touched; zero where they did not. Each pair comes after the one asked for
    /// before.
    fn direction(&mut self, shapes: [u32; 2]) -> [T; 3] {
        let [a, b] = shapes;
        let key = [a.min(b), a.max(b)];
        while self.next < self.impulse.remembered(self.state) {
            let contact = self.impulse.recall(self.next, self.state);
            if contact.key() >= key {
                let same = contact.shapes() == shapes;
                return if same {
                    contact.normal()
                } else {
                    [T::zero(); 3]
                };
            }
            self.next += 1;
        }
        [T::zero(); 3]
    }
}
