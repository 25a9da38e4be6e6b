//! A hillside of triangles.

use super::pile::solid;
use super::stuff::{RUBBER, STONE, Stuff, WOOD};
use crate::model::Subject;
use crate::{Builder, Geometry, Model, ModelError, Pose, TriangleMesh};
use glam::{DQuat, DVec2, DVec3};

/// Cells along x and z, and their width [m].
const CELLS: [usize; 2] = [64, 44];
const WIDTH: f64 = 0.1;
/// Radius of the ball [m].
const RADIUS: f64 = 0.1;

/// A height field of 6.4 m × 4.4 m: a hillside, with bumps on one half of it, above a level meadow
/// that rises to a rim. Solids of six kinds lie in rows above the bumps; a ball lies on the smooth
/// half.
///
/// To see: the solids tumble down over the bumps, and come to rest on the meadow. The ball rolls down,
/// straight over the meadow, whose triangles it does not feel, up the rim on the other side and back.
///
/// # Errors
/// If there are no solids, or more than fifty.
pub fn terrain(solids: usize) -> Result<Model, ModelError> {
    let subject = Subject {
        kind: "terrain",
        name: "",
    };
    subject.within("number of solids", solids as f64, 1.0, 50.0)?;
    let mut world = Builder::new(format!("terrain_{solids}"));
    world.time_step(0.002);
    let hillside = STONE.shape(Geometry::Mesh(hillside()?));
    world.object("ground").scenery(hillside.named("hillside"));
    let things = world.object("things");
    for i in 0..solids {
        let (name, geometry) = solid(i);
        let place = DVec2::new(-2.8 + 0.3 * (i / 5) as f64, -1.2 + 0.3 * (i % 5) as f64);
        let turn = DQuat::from_rotation_y(0.7 * i as f64);
        things
            .body(format!("{name}_{i}"))
            .at(Pose::new(above(place, 0.25), turn))
            .shape([WOOD, STONE][i % 2].shape(geometry));
    }
    let ball = Stuff {
        restitution: 0.0,
        ..RUBBER
    };
    things
        .body("ball")
        .at(Pose::at(above(DVec2::new(-2.0, 1.0), 1.2 * RADIUS)))
        .shape(ball.shape(Geometry::Sphere { radius: RADIUS }));
    world.build()
}

/// A point so far above the ground [m].
fn above(place: DVec2, by: f64) -> DVec3 {
    DVec3::new(place.x, height(place.x, place.y) + by, place.y)
}

fn hillside() -> Result<TriangleMesh, ModelError> {
    let at = |i: usize, cells: usize| WIDTH * (i as f64 - cells as f64 / 2.0);
    let [nx, nz] = CELLS;
    let row = |z: usize| (0..=nx).map(|x| height(at(x, nx), at(z, nz))).collect();
    let heights: Vec<Vec<_>> = (0..=nz).map(row).collect();
    Ok(TriangleMesh::height_field(&heights, DVec2::splat(WIDTH))?)
}

/// Of the ground [m]: level for x from 0 to 2 and |z| up to 1.5.
fn height(x: f64, z: f64) -> f64 {
    let beyond = |x: f64| x.max(0.0).powi(2);
    let slopes = 0.3 * beyond(-x) + 2.0 * (beyond(x - 2.0) + beyond(z.abs() - 1.5));
    let fade = (-x - 0.5).clamp(0.0, 1.0) * (0.6 - z).clamp(0.0, 1.0);
    slopes + 0.06 * fade * (5.0 * x).sin() * (4.0 * z).sin()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_meadow_is_level_and_nothing_lies_below_the_ground() {
        let model = terrain(15).unwrap();
        let Geometry::Mesh(mesh) = &model.shapes[0].geometry else {
            unreachable!("the ground comes first");
        };
        assert_eq!(mesh.triangles().len(), 2 * CELLS[0] * CELLS[1]);
        let meadow = |v: &&DVec3| (0.0..=2.0).contains(&v.x) && v.z.abs() <= 1.5;
        let meadow: Vec<_> = mesh.vertices().iter().filter(meadow).collect();
        assert!(meadow.len() > 600 && meadow.iter().all(|v| v.y.abs() < 1e-12));
        for body in &model.bodies {
            let place = body.pose.position;
            let over = place.y - height(place.x, place.z);
            assert!(over > RADIUS && over < 0.3, "{}: {over}", body.name);
        }
    }
}
