//! Solids and meshes on meshes: the distance is that of the surface, and seams are not felt.

mod common;
mod shader;

use common::kernel::manifold;
use common::reference::{best_gap, gap, outside, support};
use common::world::state;
use common::{Pair, Solid, V, turn, unit};
use fastrand::Rng;
use glam::{DVec2, DVec3};
use kinetarium_collide::mesh::{
    MeshData, MeshTables, SLOTS, Surface, contact, mesh_convex, mesh_mesh,
};
use kinetarium_collide::{FAR, FLAT, Placed, Tables, kind};
use model::{Hull, TriangleMesh};
use numbers::dispatch::{Isa, Job, run_block, run_single};
use numbers::machine::space::State;
use numbers::machine::{Links, Machine};
use numbers::trace::{self, PrintOptions};
use numbers::{Cpu, Float, Lanes, Memory, Pose, Quat, Shared, Table};

const MARGIN: f64 = 0.02;

/// A mesh, and a solid or another mesh, in the memories of a machine.
struct World {
    tables: Tables,
    meshes: MeshTables,
    groups: [usize; 2],
    /// Of the other mesh, if it is one.
    first: Option<[usize; 2]>,
    /// Size, position, orientation of the other; the same of the mesh.
    solids: Table<State, 10>,
    parameters: Vec<f64>,
    links: Vec<u32>,
    kinds: Links<3>,
    scratch: usize,
    /// Of the other and the mesh, in their own frames.
    centers: [V; 2],
}

/// A contact as read back.
#[derive(Debug)]
struct Contact {
    position: V,
    normal: V,
    distance: f64,
}

impl World {
    /// Of a mesh and a solid; the solid's vertices come first.
    fn new(mesh: &TriangleMesh, solid: &Solid) -> Self {
        let mut data = MeshData::default();
        let groups = data.add(mesh);
        Self::with(data, groups, None, solid, [V::zero(), middle(mesh)])
    }

    /// Of two meshes.
    fn of_meshes(a: &TriangleMesh, b: &TriangleMesh) -> Self {
        let mut data = MeshData::default();
        let [first, groups] = [a, b].map(|mesh| data.add(mesh));
        let centers = [a, b].map(middle);
        Self::with(data, groups, Some(first), &of_mesh(a), centers)
    }

    fn with(
        data: MeshData,
        groups: [usize; 2],
        first: Option<[usize; 2]>,
        solid: &Solid,
        centers: [V; 2],
    ) -> Self {
        let (mut parameters, mut links, mut scratch) = (0, 0, 0);
        let own = solid.vertices.len();
        let tables = Tables::place(&mut parameters, own + data.vertex_rows(), &mut scratch);
        let meshes = data.place(&mut parameters, &mut links, &mut scratch);
        let kinds = Links::<3>::place(&mut links, 1);
        let mut world = Self {
            tables,
            meshes,
            groups,
            first,
            solids: Table::place(&mut 0, 2),
            parameters: vec![0.0; parameters],
            links: vec![0; links],
            kinds,
            scratch,
            centers,
        };
        data.write(
            &meshes,
            tables.vertices,
            own,
            &mut world.parameters,
            &mut world.links,
        );
        for (i, v) in solid.vertices.iter().enumerate() {
            let at = tables.vertices.at(i, 0);
            world.parameters[at..at + 3].copy_from_slice(&v.to_array());
        }
        let range = [solid.kind, 0, own].map(|x| x as u32);
        world.links[kinds.start()..][..3].copy_from_slice(&range);
        world
    }

    fn run<M: Machine>(&self, k: &mut M) {
        let (first, second) = (k.index(0), k.index(1));
        let solid = kinetarium_collide::Solid {
            kind: k.link(self.kinds, first, 0),
            placed: Placed::new(k.vec3(self.solids, first, 0), k.pose(self.solids, first, 3)),
            rows: [k.link(self.kinds, first, 1), k.link(self.kinds, first, 2)],
        };
        let surface = Surface {
            placed: Placed::new(
                k.vec3(self.solids, second, 0),
                k.pose(self.solids, second, 3),
            ),
            groups: self.groups.map(|g| k.index(g)),
        };
        let margin = numbers::Real::lit(MARGIN);
        match self.first {
            None => mesh_convex(k, self.tables, &self.meshes, &solid, &surface, margin),
            Some(first) => {
                let other = Surface {
                    placed: solid.placed,
                    groups: first.map(|g| k.index(g)),
                };
                mesh_mesh(k, self.tables, &self.meshes, &other, &surface, margin);
            }
        }
    }

    /// The scratch after a run of the kernel, with the solid and the mesh in these poses.
    fn scratch<T: Float>(&self, solid: &Solid, poses: [Pose<f64>; 2]) -> Vec<T> {
        self.with_machine(solid, poses, |k| self.run(k))
    }

    /// The scratch after something ran.
    fn with_machine<T: Float>(
        &self,
        solid: &Solid,
        poses: [Pose<f64>; 2],
        run: impl for<'a> FnOnce(&mut Cpu<'a, T, Shared<'a, T>>),
    ) -> Vec<T> {
        let under = Solid::new(kind::PLANE, 0.0, 0.0, 0.0);
        let solids = [solid.clone(), under];
        let poses = self.centered(poses);
        let numbers = |x: &[f64]| x.iter().map(|&x| T::from_f64(x)).collect::<Vec<_>>();
        let parameters = numbers(&self.parameters);
        let mut scratch = vec![T::zero(); self.scratch];
        run(&mut Cpu {
            state: &mut numbers(&state(&Pair { solids, poses })),
            input: &[],
            output: &mut [],
            scratch: &mut scratch,
            parameters: Shared(&parameters),
            links: &self.links,
        });
        scratch
    }

    /// The same poses, those of meshes at their centres.
    fn centered(&self, [a, b]: [Pose<f64>; 2]) -> [Pose<f64>; 2] {
        let at = |center| Pose::new(center, Quat::identity());
        [a * at(self.centers[0]), b * at(self.centers[1])]
    }

    fn contacts<T: Float>(&self, solid: &Solid, poses: [Pose<f64>; 2]) -> Vec<Contact> {
        let scratch = self.scratch::<T>(solid, poses);
        let at = |slot: usize, field: usize| scratch[self.meshes.contacts.at(slot, field)].to_f64();
        let vector = |slot, f| V::new(at(slot, f), at(slot, f + 1), at(slot, f + 2));
        (0..SLOTS)
            .map(|slot| Contact {
                position: vector(slot, contact::POSITION),
                normal: vector(slot, contact::NORMAL),
                distance: at(slot, contact::DISTANCE),
            })
            .filter(|c| c.distance < 0.5 * FAR)
            .collect()
    }
}

fn middle(mesh: &TriangleMesh) -> V {
    V::from_array(mesh.center().to_array())
}

/// What the kernel knows of a mesh besides its triangles.
fn of_mesh(mesh: &TriangleMesh) -> Solid {
    let [x, y, z] = mesh.half_extents().to_array();
    Solid::new(kind::MESH, x, y, z)
}

fn still(x: f64, y: f64, z: f64) -> Pose<f64> {
    Pose::new(V::new(x, y, z), Quat::identity())
}

/// A level floor of triangles of all shapes, 8 m wide.
fn floor(rng: &mut Rng) -> TriangleMesh {
    let flat = TriangleMesh::height_field(&vec![vec![0.0; 17]; 17], DVec2::splat(0.5)).unwrap();
    let moved = |v: &DVec3| {
        let inside = v.x.abs() < 3.9 && v.z.abs() < 3.9;
        let mut by = || if inside { 0.4 * (rng.f64() - 0.5) } else { 0.0 };
        *v + DVec3::new(by(), 0.0, by())
    };
    let vertices: Vec<_> = flat.vertices().iter().map(moved).collect();
    TriangleMesh::new(&vertices, flat.triangles()).unwrap()
}

/// How low a solid reaches.
fn lowest(solid: &Solid, pose: Pose<f64>) -> f64 {
    let down = pose.q.rotate_inverse(V::new(0.0, -1.0, 0.0));
    pose.point(support(solid, down)).y
}

/// On a level floor of triangles all contacts are those of a plane.
fn floor_is_a_plane<T: Float>(poses: usize, tolerance: f64) {
    let mut rng = Rng::with_seed(17);
    let mesh = floor(&mut rng);
    for kind in kind::SPHERE..kind::CONVEX {
        let mut touched = 0;
        for _ in 0..poses / 100 {
            let solid = Solid::random(kind, &mut rng);
            let world = World::new(&mesh, &solid);
            for _ in 0..100 {
                let q = turn(&mut rng);
                let low = lowest(&solid, Pose::new(V::zero(), q));
                let depth = 0.1 * (rng.f64() - 0.4);
                let (x, z) = (2.0 * (rng.f64() - 0.5), 2.0 * (rng.f64() - 0.5));
                let pose = Pose::new(V::new(x, -low - depth, z), q);
                // A surface is touched from its front.
                if pose.p.y <= 0.0 {
                    continue;
                }
                let found = world.contacts::<T>(&solid, [pose, still(0.0, 0.0, 0.0)]);
                if depth < -MARGIN - tolerance {
                    assert!(found.is_empty(), "{found:#?}");
                    continue;
                }
                // Rims and rounded faces within `FLAT` of level have their points a little higher.
                if depth < -MARGIN + 0.01 {
                    continue;
                }
                let least = found.iter().map(|c| c.distance).fold(FAR, f64::min);
                assert!(
                    (least + depth).abs() < 0.01 + tolerance,
                    "{least} at depth {depth}: {solid:#?} {pose:#?} {found:#?}"
                );
                assert!(
                    least + depth > -tolerance,
                    "{least} at depth {depth}: {solid:#?} {pose:#?}"
                );
                for c in &found {
                    let up = c.normal + V::new(0.0, 1.0, 0.0);
                    assert!(
                        up.length() < 1e-5,
                        "{c:#?} at depth {depth}: {solid:#?} {pose:#?}"
                    );
                    let middle = 0.5 * c.distance;
                    assert!((c.position.y - middle).abs() < 0.005, "{c:#?}");
                }
                touched += 1;
            }
        }
        assert!(touched > poses / 3, "{kind}: {touched}");
    }
}

#[test]
fn a_level_floor_is_a_plane_in_f32() {
    floor_is_a_plane::<f32>(3000, 1e-5);
}

#[test]
fn a_level_floor_is_a_plane_in_f64() {
    floor_is_a_plane::<f64>(300, 1e-8);
}

/// The point of a triangle nearest to x, by projection and by edges.
fn nearest_on_triangle(x: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let on_edge = |p: DVec3, q: DVec3| {
        let t = (x - p).dot(q - p) / (q - p).length_squared();
        p + (q - p) * t.clamp(0.0, 1.0)
    };
    let n = (b - a).cross(c - a).normalize();
    let foot = x - n * n.dot(x - a);
    let inside = [(a, b), (b, c), (c, a)]
        .into_iter()
        .all(|(p, q)| (q - p).cross(foot - p).dot(n) >= 0.0);
    let edges = [on_edge(a, b), on_edge(b, c), on_edge(c, a)];
    let nearest = |p: DVec3, q: DVec3| if x.distance(p) < x.distance(q) { p } else { q };
    let rim = edges.into_iter().reduce(nearest).unwrap();
    if inside { foot } else { rim }
}

/// Hills and valleys, a height field.
fn hills() -> TriangleMesh {
    let height =
        |r: usize, c: usize| 0.3 * (1.3 * r as f64).sin() + 0.25 * (0.9 * c as f64 + 0.4).cos();
    let heights: Vec<Vec<_>> = (0..21)
        .map(|r| (0..25).map(|c| height(r, c)).collect())
        .collect();
    TriangleMesh::height_field(&heights, DVec2::splat(0.4)).unwrap()
}

/// A sphere on hills is as far from them as its centre is from the nearest triangle, less its radius.
#[test]
fn spheres_on_a_height_field() {
    let mesh = hills();
    let solid = Solid::new(kind::SPHERE, 0.3, 0.0, 0.0);
    let world = World::new(&mesh, &solid);
    let mut rng = Rng::with_seed(19);
    let mut touched = 0;
    for _ in 0..5000 {
        let (x, z) = (6.0 * (rng.f64() - 0.5), 6.0 * (rng.f64() - 0.5));
        let pose = still(x, rng.f64() - 0.2, z);
        let center = DVec3::from(pose.p.to_array());
        let nearest = mesh
            .triangles()
            .iter()
            .map(|t| nearest_on_triangle(center, t.map(|v| mesh.vertices()[v as usize])));
        let nearest = nearest
            .min_by(|p, q| center.distance(*p).total_cmp(&center.distance(*q)))
            .unwrap();
        let distance = center.distance(nearest) - 0.3;
        let above = center.y > nearest.y;
        let found = world.contacts::<f32>(&solid, [pose, still(0.0, 0.0, 0.0)]);
        if !above || distance < -0.2 {
            continue;
        }
        let least = found.iter().map(|c| c.distance).fold(FAR, f64::min);
        if distance > MARGIN + 1e-5 {
            assert!(found.is_empty(), "{distance}: {found:#?}");
        } else if distance < MARGIN - 1e-5 {
            assert!(
                (least - distance).abs() < 2e-5,
                "{least} for {distance} at {pose:#?}: {found:#?}"
            );
            touched += 1;
        }
    }
    assert!(touched > 500, "{touched}");
}

/// In any pose of mesh and solid together the contacts are the same.
#[test]
fn contacts_move_along_with_both() {
    let mesh = hills();
    let mut rng = Rng::with_seed(23);
    for kind in kind::SPHERE..kind::CONVEX {
        let solid = Solid::random(kind, &mut rng);
        let world = World::new(&mesh, &solid);
        let (q, outer) = (turn(&mut rng), Pose::new(unit(&mut rng), turn(&mut rng)));
        // Lowered until it touches.
        let (inner, here) = (0..100)
            .map(|i| Pose::new(V::new(0.3, 2.5 - 0.03 * f64::from(i), -0.2), q))
            .map(|p| (p, world.contacts::<f64>(&solid, [p, still(0.0, 0.0, 0.0)])))
            .find(|(_, found)| !found.is_empty())
            .unwrap();
        let there = world.contacts::<f64>(&solid, [outer * inner, outer]);
        assert_eq!(here.len(), there.len());
        for (a, b) in here.iter().zip(&there) {
            assert!(
                (outer.point(a.position) - b.position).length() < 1e-6,
                "{a:#?} {b:#?}"
            );
            assert!((outer.q.rotate(a.normal) - b.normal).length() < 1e-6);
            assert!((a.distance - b.distance).abs() < 1e-6);
        }
    }
}

/// Brings the first of two solids, turned anyhow, to a small depth along a line of centres, which leaves
/// them touching; answers their distance, where that is what it was to be.
fn touching(pair: &mut Pair, rng: &mut Rng) -> Option<f64> {
    let (way, depth) = (unit(rng), 0.03 * rng.f64() - 0.015);
    pair.poses[0] = Pose::new(way * 3.0, turn(rng));
    for _ in 0..30 {
        let step = best_gap(pair) + depth;
        pair.poses[0].p -= way * step;
        if step.abs() < 1e-6 {
            break;
        }
    }
    let distance = best_gap(pair);
    ((distance + depth).abs() <= 1e-3).then_some(distance)
}

/// The deepest of the contacts of a solid with the surface of a hull: by how much its distance is not that of the two,
/// its normal is not one along which they are that far apart, or it lies off their surfaces.
fn off_the_hull(pair: &Pair, found: &[Contact], distance: f64) -> f64 {
    let deepest = found
        .iter()
        .min_by(|a, b| a.distance.total_cmp(&b.distance));
    let Some(c) = deepest else { return FAR };
    let half = c.normal * (0.5 * c.distance);
    let ends = [c.position - half, c.position + half];
    let beside = [0, 1].map(|i| outside(&pair.solids[i], pair.poses[i], ends[i]));
    [
        (c.distance - distance).abs(),
        (gap(pair, c.normal) - distance).abs(),
        beside[0],
        beside[1],
    ]
    .into_iter()
    .fold(0.0, f64::max)
}

/// The solid, a hull about its centre, which is inside.
fn centred(solid: Solid) -> Solid {
    if solid.kind != kind::HULL {
        return solid;
    }
    let points: Vec<_> = solid
        .vertices
        .iter()
        .map(|v| DVec3::from(v.to_array()))
        .collect();
    let center = V::from_array(Hull::new(&points).unwrap().center().to_array());
    Solid::hull(solid.vertices.iter().map(|v| *v - center).collect())
}

/// The surface of a convex solid is touched where the solid is, in ten thousand poses of solids of these kinds.
fn surfaces_of_hulls(kinds: impl Iterator<Item = usize>) {
    let mut rng = Rng::with_seed(47);
    for kind in kinds {
        let (mut touched, mut missed, mut wrong) = (0, 0, 0);
        while touched < 10_000 {
            let mesh = lump(&mut rng);
            let solid = centred(Solid::random(kind, &mut rng));
            let world = World::new(&mesh, &solid);
            let mut pair = Pair {
                solids: [solid.clone(), Solid::hull(vertices(&mesh))],
                poses: [still(0.0, 0.0, 0.0); 2],
            };
            for _ in 0..100 {
                let Some(distance) = touching(&mut pair, &mut rng) else {
                    continue;
                };
                let found = world.contacts::<f32>(&solid, pair.poses);
                let off = off_the_hull(&pair, &found, distance);
                touched += 1;
                missed += usize::from(off > 1e-3);
                wrong += usize::from(off > 0.02);
            }
        }
        println!("{kind}: {missed} of {touched} missed, {wrong} of them by far");
        assert_eq!(wrong, 0, "{kind}: {wrong} of {touched}");
        assert!(missed * 100 < touched, "{kind}: {missed} of {touched}");
    }
}

#[test]
fn the_surface_of_a_hull_is_the_hull_to_even_kinds() {
    surfaces_of_hulls((kind::SPHERE..kind::CONVEX).step_by(2));
}

#[test]
fn the_surface_of_a_hull_is_the_hull_to_odd_kinds() {
    surfaces_of_hulls((kind::SPHERE..kind::CONVEX).skip(1).step_by(2));
}

/// Brings a solid down onto a surface to a small gap, which is that to the nearest of its triangles, each a hull of three
/// points; answers the gap, if the solid lies above.
fn lowered(
    solid: &Solid,
    mesh: &TriangleMesh,
    q: Quat<f64>,
    rng: &mut Rng,
) -> Option<(Pose<f64>, f64)> {
    let (x, z) = (4.0 * (rng.f64() - 0.5), 4.0 * (rng.f64() - 0.5));
    let wish = 0.002 + 0.016 * rng.f64();
    let mut pose = Pose::new(V::new(x, 2.0, z), q);
    let corners = |t: &[u32; 3]| t.map(|v| V::from_array(mesh.vertices()[v as usize].to_array()));
    let near: Vec<_> = mesh
        .triangles()
        .iter()
        .map(corners)
        .filter(|t| {
            let (dx, dz) = (t[0].x - x, t[0].z - z);
            dx.hypot(dz) < solid.reach() + 0.6
        })
        .map(|t| Solid::hull(t.to_vec()))
        .collect();
    for _ in 0..60 {
        let distance = near.iter().map(|triangle| {
            let solids = [solid.clone(), triangle.clone()];
            best_gap(&Pair {
                solids,
                poses: [pose, still(0.0, 0.0, 0.0)],
            })
        });
        let distance = distance.fold(FAR, f64::min);
        if distance < 0.001 {
            return None;
        }
        if (distance - wish).abs() < 1e-3 {
            return Some((pose, distance));
        }
        pose.p.y -= distance - wish;
    }
    None
}

/// Solids of all kinds that hover over hills are as far from them as from the nearest triangle by another engine's search,
/// or by less than [`FLAT`] of their size farther, where they lie nearly along it.
#[test]
fn solids_over_a_height_field() {
    let mesh = hills();
    let mut rng = Rng::with_seed(61);
    for kind in kind::SPHERE..kind::CONVEX {
        let mut met = 0;
        for _ in 0..10 {
            let mut solid = centred(Solid::random(kind, &mut rng));
            solid.size = solid.size * 0.5;
            for vertex in &mut solid.vertices {
                *vertex = *vertex * 0.5;
            }
            let world = World::new(&mesh, &solid);
            for _ in 0..30 {
                let q = turn(&mut rng);
                let Some((pose, distance)) = lowered(&solid, &mesh, q, &mut rng) else {
                    continue;
                };
                let found = world.contacts::<f32>(&solid, [pose, still(0.0, 0.0, 0.0)]);
                let least = found.iter().map(|c| c.distance).fold(FAR, f64::min);
                let off = least - distance;
                assert!(
                    off > -2e-5 && off < FLAT * solid.reach(),
                    "{least} for {distance}: {solid:#?} {pose:#?} {found:#?}"
                );
                met += 1;
            }
        }
        assert!(met > 200, "{kind}: {met}");
    }
}

/// All numbers of contacts are finite, their normals of unit length.
fn sane(found: &[Contact], what: &str) {
    for c in found {
        let [x, y, z] = c.position.to_array();
        let numbers = [x, y, z, c.distance, c.normal.length()];
        let finite = numbers.iter().all(|x| x.is_finite());
        assert!(
            finite && (c.normal.length() - 1.0).abs() < 1e-4,
            "{what}: {c:#?}"
        );
    }
}

/// Of triangles: a flat sheet, needles, ones with edges in a line, and a closed box; in one place, on each other, turned by
/// quarters, and by next to nothing.
#[test]
fn degenerate_poses_of_meshes_are_finite() {
    let square = |y: f64| {
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, z]| DVec3::new(x, y, z))
    };
    let sheet = TriangleMesh::new(&square(0.0), &[[0, 2, 1], [0, 3, 2]]).unwrap();
    let needle = |thin: f64| {
        let corners = [
            DVec3::new(-1.0, 0.0, 0.0),
            DVec3::new(1.0, 0.0, 0.0),
            DVec3::new(0.9, 0.0, -thin),
        ];
        TriangleMesh::new(&corners, &[[0, 1, 2]]).unwrap()
    };
    let corner =
        |i: u32| 0.5 * DVec3::from_array([i, i >> 1, i >> 2].map(|b| f64::from(b & 1) * 2.0 - 1.0));
    let corners: Vec<_> = (0..8).map(corner).collect();
    let hull = Hull::new(&corners).unwrap();
    let closed = TriangleMesh::new(hull.vertices(), hull.triangles()).unwrap();
    let meshes = [
        ("sheet", sheet),
        ("needle", needle(1e-3)),
        ("thread", needle(1e-6)),
        ("box", closed),
        ("ring", torus(0.5, 0.2, 6)),
    ];
    let s = 0.5f64.sqrt();
    let turns = [
        Quat::identity(),
        Quat::new(s, 0.0, 0.0, s),
        Quat::new(0.0, s, 0.0, s),
        Quat::new(0.0, 0.0, s, s),
        Quat::new(1.0, 0.0, 0.0, 0.0),
        Quat::new(1e-7, 0.0, 0.0, 1.0),
    ];
    let places = [
        V::zero(),
        V::new(0.0, 1e-7, 0.0),
        V::new(0.0, 0.01, 0.0),
        V::new(0.0, 1.0, 0.0),
        V::new(1.0, 0.0, 0.0),
        V::new(-0.5, -0.5, 0.5),
    ];
    let mut found_any = 0;
    for (a_name, a) in &meshes {
        for (b_name, b) in &meshes {
            let world = World::of_meshes(a, b);
            for (q, p) in turns.iter().flat_map(|q| places.map(|p| (*q, p))) {
                let poses = [Pose::new(p, q), still(0.0, 0.0, 0.0)];
                let what = format!("{a_name} on {b_name}, {p:?} {q:?}");
                let single = world.contacts::<f32>(&of_mesh(a), poses);
                sane(&single, &what);
                sane(&world.contacts::<f64>(&of_mesh(a), poses), &what);
                found_any += usize::from(!single.is_empty());
            }
        }
        // Solids, flat ones among them, on the same.
        for kind in kind::SPHERE..kind::CONVEX {
            for size in [[0.3, 0.5, 0.4], [1.0, 1e-3, 1.0], [1e-3, 1.0, 1e-3]] {
                let [x, y, z] = size;
                let solid = match kind {
                    kind::CAPSULE => Solid::new(kind, x, y.max(1.01 * x), 0.0),
                    kind::HULL => Solid::hull(
                        corners
                            .iter()
                            .map(|c| V::new(c.x * x, c.y * y, c.z * z))
                            .collect(),
                    ),
                    _ => Solid::new(kind, x, y, z),
                };
                let world = World::new(a, &solid);
                for (q, p) in turns.iter().flat_map(|q| places.map(|p| (*q, p))) {
                    let poses = [Pose::new(p, q), still(0.0, 0.0, 0.0)];
                    let what = format!("{solid:?} on {a_name}, {p:?} {q:?}");
                    sane(&world.contacts::<f32>(&solid, poses), &what);
                    sane(&world.contacts::<f64>(&solid, poses), &what);
                }
            }
        }
    }
    assert!(found_any > 200, "{found_any}");
}

/// A ring of a round cross-section about the y axis, of `n` times `n` quadrangles.
fn torus(radius: f64, thick: f64, n: u32) -> TriangleMesh {
    let turn = |i: u32| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
    let vertex = |i: u32, j: u32| {
        let ((s, c), (sin, cos)) = (turn(i).sin_cos(), turn(j).sin_cos());
        let out = radius + thick * cos;
        DVec3::new(out * c, thick * sin, out * s)
    };
    let vertices: Vec<_> = (0..n * n).map(|v| vertex(v / n, v % n)).collect();
    let number = |i: u32, j: u32| (i % n) * n + j % n;
    let square = |(i, j): (u32, u32)| {
        let [a, b, c, d] =
            [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)].map(|(i, j)| number(i, j));
        [[a, b, c], [a, c, d]]
    };
    let squares = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let triangles: Vec<_> = squares.flat_map(square).collect();
    TriangleMesh::new(&vertices, &triangles).unwrap()
}

/// The surface of a hull of random points on a ball.
fn lump(rng: &mut Rng) -> TriangleMesh {
    let points: Vec<_> = (0..20).map(|_| DVec3::from(unit(rng).to_array())).collect();
    let hull = Hull::new(&points).unwrap();
    TriangleMesh::new(hull.vertices(), hull.triangles()).unwrap()
}

fn vertices(mesh: &TriangleMesh) -> Vec<V> {
    let vertices = mesh.vertices().iter();
    vertices.map(|v| V::from_array(v.to_array())).collect()
}

/// On a level floor of triangles a mesh, hollow or not, is as deep as its lowest vertex, and is pushed
/// straight up.
#[test]
fn meshes_on_a_level_floor() {
    let mut rng = Rng::with_seed(53);
    let floor = floor(&mut rng);
    for mesh in [torus(0.3, 0.1, 16), lump(&mut rng)] {
        let world = World::of_meshes(&mesh, &floor);
        let solid = of_mesh(&mesh);
        for _ in 0..500 {
            let q = turn(&mut rng);
            let heights = vertices(&mesh).into_iter().map(|v| q.rotate(v).y);
            let lowest = heights.fold(FAR, f64::min);
            let depth = 0.05 * (rng.f64() - 0.4);
            let (x, z) = (2.0 * (rng.f64() - 0.5), 2.0 * (rng.f64() - 0.5));
            let pose = Pose::new(V::new(x, -lowest - depth, z), q);
            let found = world.contacts::<f32>(&solid, [pose, still(0.0, 0.0, 0.0)]);
            let least = found.iter().map(|c| c.distance).fold(FAR, f64::min);
            if depth < -MARGIN - 1e-5 {
                assert!(found.is_empty(), "{depth}: {found:#?}");
                continue;
            }
            if depth < -MARGIN + 1e-5 {
                continue;
            }
            // One in a corner may stand for one that is a little deeper.
            let above = least + depth;
            let close = 1e-3 * mesh.half_extents().length();
            assert!(
                above > -1e-5 && above < close + 1e-5,
                "{least} at {depth}: {pose:#?} {found:#?}"
            );
            for c in &found {
                let up = c.normal + V::new(0.0, 1.0, 0.0);
                assert!(up.length() < 1e-5, "{c:#?} at {depth}: {pose:#?}");
            }
        }
    }
}

/// The surfaces of two convex solids touch where the solids do, whichever comes first.
#[test]
fn the_surfaces_of_two_hulls_are_the_hulls() {
    let mut rng = Rng::with_seed(59);
    let (mut touched, mut missed) = (0, 0);
    for _ in 0..100 {
        let meshes = [(); 2].map(|()| lump(&mut rng));
        let [a, b] = &meshes;
        let (there, back) = (World::of_meshes(a, b), World::of_meshes(b, a));
        let mut pair = Pair {
            solids: [a, b].map(|mesh| Solid::hull(vertices(mesh))),
            poses: [still(0.0, 0.0, 0.0); 2],
        };
        for _ in 0..20 {
            let Some(distance) = touching(&mut pair, &mut rng) else {
                continue;
            };
            touched += 1;
            let [p, q] = pair.poses;
            let found = there.contacts::<f32>(&of_mesh(a), [p, q]);
            let least = found.iter().map(|c| c.distance).fold(FAR, f64::min);
            let turned = back.contacts::<f32>(&of_mesh(b), [q, p]);
            let other = turned.iter().map(|c| c.distance).fold(FAR, f64::min);
            missed += usize::from((least - distance).abs().max((other - distance).abs()) > 1e-3);
            assert!(
                (least - distance).abs() < 0.02 && (other - distance).abs() < 0.02,
                "{least}, {other}, {distance}: {found:#?} {turned:#?} {pair:#?}"
            );
        }
    }
    assert!(
        touched > 1000 && missed * 50 < touched,
        "{missed} of {touched}"
    );
}

/// A box of two triangles a side, each cut along a diagonal of its own.
fn box_mesh(half: V, rng: &mut Rng) -> TriangleMesh {
    let corner = |i: u32| {
        let [x, y, z] = [i, i >> 1, i >> 2].map(|b| f64::from(b & 1) * 2.0 - 1.0);
        DVec3::new(x * half.x, y * half.y, z * half.z)
    };
    let vertices: Vec<_> = (0..8).map(corner).collect();
    let sides = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles = sides.into_iter().flat_map(|[a, b, c, d]: [u32; 4]| {
        if rng.bool() {
            [[a, b, c], [a, c, d]]
        } else {
            [[b, c, d], [b, d, a]]
        }
    });
    let triangles: Vec<_> = triangles.collect();
    TriangleMesh::new(&vertices, &triangles).unwrap()
}

/// A box on another one, both of triangles: turned by up to `tilt` [rad], moved by up to `offset` [m], and let in by half
/// a percent to thirty percent of its thickness.
fn sunk(meshes: [&TriangleMesh; 2], tilt: f64, offset: f64, rng: &mut Rng) -> (Pair, f64) {
    let mut within = || 2.0 * rng.f64() - 1.0;
    let axis = V::new(within(), 0.3 * within(), within());
    let turn = Quat::from_axis_angle(axis * axis.length().recip(), tilt * within());
    let (x, z) = (offset * within(), offset * within());
    let depth = 0.1 * 0.005 * 60f64.powf(rng.f64());
    let mut pair = Pair {
        solids: meshes.map(|mesh| Solid::hull(vertices(mesh))),
        poses: [Pose::new(V::new(x, 0.1, z), turn), still(0.0, 0.0, 0.0)],
    };
    for _ in 0..20 {
        pair.poses[0].p.y -= depth + best_gap(&pair);
    }
    (pair, depth)
}

/// However deep one box of triangles has got into another, it is pushed back out: as far as the hulls overlap, and where
/// they do, whichever way the sides are cut into triangles.
#[test]
fn boxes_of_triangles_never_fall_through_each_other() {
    let mut rng = Rng::with_seed(67);
    let half = V::new(0.1, 0.05, 0.1);
    for tilt in [0.002, 0.01, 0.03, 0.1] {
        let (mut met, mut off, mut bare, mut alone) = (0, 0, 0, 0);
        for i in 0..600 {
            let meshes = [(); 2].map(|()| box_mesh(half, &mut rng));
            let [a, b] = &meshes;
            let offset = [0.001, 0.01, 0.06][i % 3];
            let (pair, depth) = sunk([a, b], tilt, offset, &mut rng);
            let distance = best_gap(&pair);
            if (distance + depth).abs() > 1e-6 {
                continue;
            }
            met += 1;
            let found = World::of_meshes(a, b).contacts::<f32>(&of_mesh(a), pair.poses);
            let deepest = found
                .iter()
                .min_by(|p, q| p.distance.total_cmp(&q.distance));
            let c = deepest.unwrap_or_else(|| panic!("nothing {depth} deep: {pair:#?}"));
            let angle = (-c.normal.y).min(1.0).acos();
            assert!(angle < 2.0 * tilt + 0.01, "{c:#?} {depth} deep: {pair:#?}");
            off += usize::from((c.distance - distance).abs() > 0.1 * depth + 5e-4);
            // What bears the hulls bears the meshes, too.
            let bears = |p: V| found.iter().any(|c| (c.position - p).length() < 0.02);
            let hull = manifold::<f64>(&pair).points;
            let lacks = |share: f64| {
                let mut deep = hull.iter().filter(|p| p.distance < share * distance);
                deep.any(|p| !bears(p.position))
            };
            bare += usize::from(lacks(0.9));
            alone += usize::from(lacks(0.5));
        }
        println!("tilted by {tilt}: {off} of {met} off, {bare} bare, {alone} partly");
        assert!(met > 500 && off * 100 < met && bare * 24 < met && alone * 4 < met);
    }
}

#[test]
fn meshes_are_traced() {
    let mesh = hills();
    let mut rng = Rng::with_seed(29);
    let ring = torus(0.5, 0.3, 5);
    let solids = [kind::SPHERE, kind::BOX, kind::HULL].map(|kind| Solid::random(kind, &mut rng));
    let worlds = solids.map(|solid| (World::new(&mesh, &solid), solid));
    let both = (World::of_meshes(&ring, &mesh), of_mesh(&ring));
    for (world, solid) in worlds.into_iter().chain([both]) {
        let program = trace::record(|k| world.run(k)).unwrap();
        shader::validate(&program, &PrintOptions::default());
        for i in 0..5 {
            let pose = Pose::new(V::new(0.2, 0.2 * f64::from(i), 0.1), turn(&mut rng));
            let poses = [pose, still(0.0, 0.0, 0.0)];
            let bits = |x: Vec<f32>| x.into_iter().map(f32::to_bits).collect::<Vec<_>>();
            let kernel = bits(world.scratch(&solid, poses));
            let record = bits(world.with_machine(&solid, poses, |k| program.interpret(k).unwrap()));
            assert_eq!(kernel, record);
        }
    }
}

struct Contacts<'a> {
    world: &'a World,
    state: &'a mut [f32],
    scratch: &'a mut [f32],
    parameters: &'a [f32],
}

impl Job for Contacts<'_> {
    type Scalar = f32;
    type Output = ();
    #[inline(always)]
    fn run<R: Lanes<Scalar = f32>>(self) {
        let mut k = Cpu {
            state: bytemuck::cast_slice_mut::<f32, R>(self.state),
            input: &[],
            output: &mut [],
            scratch: bytemuck::cast_slice_mut(self.scratch),
            parameters: Shared(self.parameters),
            links: &self.world.links,
        };
        self.world.run(&mut k);
    }
}

/// Solids in lanes, each in its own place on the mesh, have the bits of each alone.
#[test]
fn meshes_have_the_same_bits_in_lanes_and_alone() {
    let mesh = hills();
    let mut rng = Rng::with_seed(41);
    let kinds = [kind::SPHERE, kind::CAPSULE, kind::BOX, kind::HULL];
    let solids = kinds.map(|kind| Solid::random(kind, &mut rng));
    let worlds = solids.map(|solid| (World::new(&mesh, &solid), solid));
    let ring = torus(0.5, 0.3, 5);
    let both = (World::of_meshes(&ring, &mesh), of_mesh(&ring));
    for (world, solid) in worlds.into_iter().chain([both]) {
        let parameters: Vec<_> = world.parameters.iter().map(|&x| x as f32).collect();
        for _ in 0..5 {
            let mut pose =
                || Pose::new(unit(&mut rng) * 1.5 + V::new(0.0, 1.0, 0.0), turn(&mut rng));
            let poses: Vec<_> = (0..f32::BLOCK).map(|_| pose()).collect();
            let run = |isa, poses: &[Pose<f64>]| {
                let width = poses.len();
                let mut states = Memory::new(width, 20, width);
                for (i, &pose) in poses.iter().enumerate() {
                    let under = Solid::new(kind::PLANE, 0.0, 0.0, 0.0);
                    let solids = [solid.clone(), under];
                    let poses = world.centered([pose, still(0.0, 0.0, 0.0)]);
                    for (offset, x) in state(&Pair { solids, poses }).into_iter().enumerate() {
                        states.set(i, offset, x as f32);
                    }
                }
                let mut scratch = Memory::new(width, world.scratch, width);
                let job = Contacts {
                    world: &world,
                    state: states.scalars_mut(),
                    scratch: scratch.scalars_mut(),
                    parameters: &parameters,
                };
                if width == 1 {
                    run_single(isa, job);
                } else {
                    run_block(isa, job);
                }
                let contacts = world.meshes.contacts;
                let fields = contacts.at(0, 0)..contacts.at(SLOTS, 0);
                let of = |w| {
                    fields
                        .clone()
                        .map(|i| scratch.get(w, i).to_bits())
                        .collect()
                };
                (0..width).map(of).collect::<Vec<Vec<u32>>>()
            };
            for isa in Isa::available() {
                let together = run(isa, &poses);
                for (pose, together) in poses.iter().zip(together) {
                    let alone = run(isa, std::slice::from_ref(pose));
                    assert_eq!(alone[0], together, "{isa}: {solid:#?} {pose:#?}");
                }
            }
        }
    }
}
