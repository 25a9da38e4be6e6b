//! One pair of solids in the memories of a machine, as a solver would hold it.

use super::kernel::manifold_of;
use super::{Pair, V};
use kinetarium_collide::{Placed, Route, Solid, Tables};
use numbers::machine::space::{Output, State};
use numbers::machine::{Links, Machine};
use numbers::{Pose, Table};

/// Numbers of a manifold: the normal, and position, distance, feature of each point.
pub const MANIFOLD: usize = 3 + 4 * 5;

/// Where a pair's numbers are.
#[derive(Clone, Copy)]
pub struct World {
    route: Route,
    tables: Tables,
    /// Size, position, orientation.
    solids: Table<State, 10>,
    /// Kind, first and last row of the vertices.
    kinds: Links<3>,
    output: Table<Output, MANIFOLD>,
    pub scratch: usize,
}

impl World {
    /// Room for a pair with this many vertices of hulls in all.
    pub fn new(route: Route, vertices: usize) -> Self {
        let (mut parameters, mut scratch) = (0, 0);
        Self {
            route,
            tables: Tables::place(&mut parameters, vertices, &mut scratch),
            solids: Table::place(&mut 0, 2),
            kinds: Links::place(&mut 0, 2),
            output: Table::place(&mut 0, 1),
            scratch,
        }
    }

    /// Reads the pair, computes its contact, writes it.
    #[inline(always)]
    pub fn run<M: Machine>(&self, k: &mut M) {
        let a = self.solid(k, k.index(0));
        let b = self.solid(k, k.index(1));
        let found = manifold_of(self.route, k, self.tables, &a, &b);
        let row = k.index(0);
        k.store_vec3(self.output, row, 0, found.normal);
        for i in 0..4 {
            let at = 3 + 5 * i;
            k.store_vec3(self.output, row, at, found.points[i].position);
            k.store(self.output, row, at + 3, found.points[i].distance);
            k.store(self.output, row, at + 4, found.points[i].feature);
        }
    }

    #[inline(always)]
    fn solid<M: Machine>(&self, k: &M, row: M::I) -> Solid<M> {
        let size = k.vec3(self.solids, row, 0);
        let pose = k.pose(self.solids, row, 3);
        Solid {
            kind: k.link(self.kinds, row, 0),
            placed: Placed::new(size, pose),
            rows: [k.link(self.kinds, row, 1), k.link(self.kinds, row, 2)],
        }
    }
}

/// The numbers of a pair's solids, as `solids` has them.
pub fn state(pair: &Pair) -> Vec<f64> {
    let of = |i: usize| {
        let (V { x, y, z }, Pose { p, q }) = (pair.solids[i].size, pair.poses[i]);
        [x, y, z, p.x, p.y, p.z, q.x, q.y, q.z, q.w]
    };
    [of(0), of(1)].concat()
}

/// The vertices of both hulls.
pub fn vertices(pair: &Pair) -> Vec<f64> {
    let all = pair.solids.iter().flat_map(|s| &s.vertices);
    all.flat_map(|v| v.to_array()).collect()
}

/// Kinds and ranges of vertices.
pub fn links(pair: &Pair) -> Vec<u32> {
    let [a, b] = &pair.solids;
    let (n, m) = (a.vertices.len(), b.vertices.len());
    [a.kind, 0, n, b.kind, n, n + m].map(|x| x as u32).to_vec()
}
