//! Camera sensors: colours, linear depth, segmentation and normals, without a window.
//!
//! A [`Scene`] is what there is to see of a model. A [`Camera`] is free or on a body, and a [`View`]
//! says what is wanted of it. Where bodies are comes from outside, a slice of poses for each world, so
//! that any simulation, recording or trajectory can be drawn; many worlds are drawn in one call, a
//! camera in each.
//!
//! ```
//! use glam::DVec3;
//! use kinetarium_render::{Camera, Channels, Scene, View, ray_caster};
//! use model::{Pose, examples};
//!
//! let model = examples::tower(10, 0.0)?;
//! let scene = Scene::new(&model)?;
//! let poses: Vec<Pose> = model.bodies.iter().map(|body| body.pose).collect();
//!
//! // From 6 m beside it, 40° from the upper to the lower edge of the image.
//! let (eye, target) = (DVec3::new(0.0, 2.0, 6.0), DVec3::new(0.0, 0.5, 0.0));
//! let camera = Camera::new(64, 48, 40_f64.to_radians()).looking(eye, target, DVec3::Y);
//! let view = View::new(camera).with_channels(Channels::ALL);
//! let images = ray_caster::render(&scene, &view, &[&poses])?;
//!
//! let depth = images.depth.unwrap(); // (1, 48, 64) [m]
//! assert!((5.0..7.0).contains(&depth[64 * 24 + 32]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! SI units, right-handed; the camera's frame is described in [`Camera`]'s module.
//!
//! | module | what |
//! |---|---|
//! | [`camera`] | pinhole cameras, their intrinsics, where they are |
//! | [`ray_caster`] | the renderer that runs everywhere, and is the reference |
//! | `gpu` | the same images from a graphics card; with the feature `gpu` |
//!
//! A [`Renderer`] is either of both, by the [`Device`] that is asked for.
//!
//! # Limits
//! - All worlds show one model: sizes that `set_world_model` gave a world of its own are not seen.
//! - Surfaces have a colour, and no texture. Meshes are seen as their flat triangles.
//! - What is seen through has no refraction, and the other channels show it as if it were not.

#![forbid(unsafe_code)]

pub mod camera;
mod error;
mod framing;
#[cfg(feature = "gpu")]
pub mod gpu;
mod lamp;
mod light;
mod mesh;
mod picture;
pub mod ray_caster;
mod renderer;
mod scene;
mod view;

pub use camera::{Camera, Lens};
pub use error::RenderError;
pub use light::Light;
pub use picture::write_png;
pub use renderer::{Device, Renderer};
pub use scene::Scene;
pub use view::{Channels, Images, View};
