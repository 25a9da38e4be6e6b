//! Models are written and read again by any format of `serde`, and are the same to the bit.

use glam::{DVec2, DVec3};
use kinetarium_model::{Builder, Geometry, Hull, Model, TriangleMesh, examples};

fn again(model: &Model) -> Model {
    let bytes = postcard::to_stdvec(model).unwrap();
    postcard::from_bytes(&bytes).unwrap()
}

#[test]
fn examples_come_back_as_they_were() {
    for model in [
        examples::n_pendula(3).unwrap(),
        examples::dominoes(5).unwrap(),
        examples::billiards().unwrap(),
    ] {
        assert_eq!(again(&model), model);
    }
}

#[test]
fn hulls_and_meshes_come_back_as_they_were() {
    let mut world = Builder::new("hulls");
    let points: Vec<_> = (0..40)
        .map(|i| {
            let a = f64::from(i);
            DVec3::new((2.4 * a).cos(), 0.3 * (1.7 * a).sin(), (2.4 * a).sin())
        })
        .collect();
    let stone = Geometry::Hull(Hull::new(&points).unwrap());
    let heights = vec![vec![0.0, 0.1, 0.0], vec![0.2, 0.1, 0.3]];
    let hills = TriangleMesh::height_field(&heights, DVec2::ONE).unwrap();
    let object = world.object("all");
    object.body("stone").shape(stone);
    object.scenery(Geometry::Mesh(hills));
    let model = world.build().unwrap();
    assert_eq!(again(&model), model);
}

#[test]
fn what_no_model_may_be_is_refused() {
    let mut parts = examples::n_pendula(2).unwrap().into_parts();
    parts.bodies[0].mass = -1.0;
    let bytes = postcard::to_stdvec(&parts).unwrap();
    assert!(postcard::from_bytes::<Model>(&bytes).is_err());
    assert!(postcard::from_bytes::<Model>(&bytes[..20]).is_err());
}
