//! Contacts as the kernels give them.

use super::{Pair, V};
use kinetarium_collide::{Kernel, Manifold, Placed, Point, Route, Solid, Tables, apart, kernel};
use numbers::{Cpu, Float, Machine, Pose, Quat, Shared, Vec3};

macro_rules! routes {
    ($($_module:ident $name:ident;)+) => {
        /// The contact of two convex solids by the kernel of a route.
        #[inline(always)]
        pub fn manifold_of<M: Machine>(
            route: Route,
            k: &mut M,
            tables: Tables,
            a: &Solid<M>,
            b: &Solid<M>,
        ) -> Manifold<M::R> {
            match route {
                $(Route::$name => kernel::$name::manifold(k, tables, a, b),)+
                Route::Mesh | Route::Meshes => panic!("a mesh has no manifold"),
            }
        }
    };
}

kinetarium_collide::with_kernels!(routes);

/// The contact of a pair, computed in `T` and read as `f64`.
pub fn manifold<T: Float>(pair: &Pair) -> Manifold<f64> {
    let (manifold, _) = meet::<T>(pair, None);
    manifold
}

/// The same of a pair whose direction is known, and how far it is apart at least.
pub fn manifold_along<T: Float>(pair: &Pair, known: V) -> (Manifold<f64>, f64) {
    meet::<T>(pair, Some(known))
}

fn meet<T: Float>(pair: &Pair, known: Option<V>) -> (Manifold<f64>, f64) {
    let rows = [0, 1].map(|i| pair.solids[i].vertices.len());
    let (mut parameters, mut scratch) = (0, 0);
    let mut tables = Tables::place(&mut parameters, rows[0] + rows[1], &mut scratch);
    if known.is_some() {
        tables = tables.remembering(&mut parameters);
    }
    let vertices = pair.solids.iter().flat_map(|solid| &solid.vertices);
    let vectors = vertices.chain(&known);
    let numbers: Vec<_> = vectors
        .flat_map(|v| v.to_array().map(T::from_f64))
        .collect();
    let mut k = Cpu {
        state: &mut [],
        input: &[],
        output: &mut [],
        scratch: &mut vec![T::zero(); scratch],
        parameters: Shared::<T>(&numbers),
        links: &[],
    };
    let [a, b] = [0, 1].map(|i| solid(&k, pair, i, [0, rows[0]][i]));
    let kinds = [0, 1].map(|i| pair.solids[i].kind);
    let route = Route::of(kinds[0], kinds[1]).expect("a route");
    let least = apart(&k, tables, &a, &b).to_f64();
    let manifold = manifold_of(route, &mut k, tables, &a, &b);
    let manifold = Manifold {
        normal: vector64(manifold.normal),
        points: manifold.points.map(|p| Point {
            position: vector64(p.position),
            distance: p.distance.to_f64(),
            feature: p.feature.to_f64(),
        }),
    };
    (manifold, least)
}

fn solid<T: Float, M: Machine<R = T>>(k: &M, pair: &Pair, i: usize, first: usize) -> Solid<M> {
    let (solid, Pose { p, q }) = (&pair.solids[i], pair.poses[i]);
    let [x, y, z, w] = [q.x, q.y, q.z, q.w].map(T::from_f64);
    let pose = Pose::new(vector(p), Quat::new(x, y, z, w).normalized());
    Solid {
        kind: k.index(solid.kind),
        placed: Placed::new(vector(solid.size), pose),
        rows: [first, first + solid.vertices.len()].map(|row| k.index(row)),
    }
}

fn vector<T: Float>(v: Vec3<f64>) -> Vec3<T> {
    Vec3::from_array(v.to_array().map(T::from_f64))
}

fn vector64<T: Float>(v: Vec3<T>) -> Vec3<f64> {
    Vec3::from_array(v.to_array().map(T::to_f64))
}
