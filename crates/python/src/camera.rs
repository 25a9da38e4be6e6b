//! Images, without a window.

use crate::error;
use crate::geometry::pose;
use crate::model::Model;
use crate::names::{Table, find, unknown};
use crate::simulation::{Engine, Precise, each, slice};
use glam::{DQuat, DVec2, DVec3, Vec3};
use kinetarium::model::{BodyId, CameraMode, Lamp, LampKind, Pose};
use kinetarium::sim::OutputPart;
use numpy::{
    IntoPyArray, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray3, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use render::{Camera, Channels, Device, Images, Lens, Light, RenderError};

fn failed(error: RenderError) -> PyErr {
    let kind = match error {
        RenderError::NotBuilt | RenderError::NoCard(_) | RenderError::Card(_) => "DeviceError",
        _ => "RenderError",
    };
    error::raise(kind, error.to_string())
}

/// A camera, and what is wanted of it.
#[pyclass(frozen, from_py_object, module = "kinetarium._engine")]
#[derive(Clone)]
pub struct View(pub render::View);

#[pymethods]
impl View {
    #[new]
    #[pyo3(signature = (model, *, width, height, field_of_view, focal, principal, near, far, body, mode, position,
        orientation, channels, samples, occlusion, light, checker))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn new(
        model: &Bound<'_, Model>,
        width: usize,
        height: usize,
        field_of_view: f64,
        focal: Option<[f64; 2]>,
        principal: Option<[f64; 2]>,
        near: f64,
        far: f64,
        body: Option<&str>,
        mode: &str,
        position: [f64; 3],
        orientation: [f64; 4],
        channels: Vec<String>,
        samples: usize,
        occlusion: usize,
        light: Option<LightDraft>,
        checker: Option<f64>,
    ) -> PyResult<Self> {
        let mut camera = Camera::new(width, height, field_of_view).at(pose(position, orientation));
        if let Some(focal) = focal {
            let middle = [0.5 * width as f64, 0.5 * height as f64];
            camera.lens = Lens::Pixels {
                focal: DVec2::from_array(focal),
                principal: DVec2::from_array(principal.unwrap_or(middle)),
            };
        }
        (camera.near, camera.far) = (near, far);
        if let Some(body) = body {
            camera = camera.on(model.get().model.body(body).map_err(error::model)?);
        }
        camera.mode = find(&MODES, "mode of cameras", mode)?;
        let view = render::View::new(camera).with_channels(self::channels(&channels)?);
        let mut view = view.with_samples(samples).with_occlusion(occlusion);
        view.checker = checker;
        if let Some(draft) = light {
            let renderer = model.get().renderer(&Device::Processor).map_err(failed)?;
            let own = &renderer.scene().light;
            view = view.with_light(draft.over(own, &model.get().model)?);
        }
        Ok(Self(view))
    }
}

/// A `kinetarium.Light`: what of the light is another than the scene's own.
#[derive(FromPyObject)]
struct LightDraft {
    to_sun: Option<[f64; 3]>,
    sun: Option<[f32; 3]>,
    shadows: Option<bool>,
    sun_radius: Option<f64>,
    sky: Option<[f32; 3]>,
    ground: Option<[f32; 3]>,
    zenith: Option<[f32; 3]>,
    horizon: Option<[f32; 3]>,
    lamps: Option<Vec<LampDraft>>,
}

impl LightDraft {
    fn over(self, own: &Light, of: &kinetarium::model::Model) -> PyResult<Light> {
        let color = |given: Option<[f32; 3]>, own| given.map_or(own, Vec3::from_array);
        let lamps = match self.lamps {
            Some(drafts) => {
                let drafts = drafts.into_iter().enumerate();
                drafts
                    .map(|(row, lamp)| lamp.lamp(row, of))
                    .collect::<PyResult<_>>()?
            }
            None => own.lamps.clone(),
        };
        Ok(Light {
            lamps,
            to_sun: self.to_sun.map_or(own.to_sun, DVec3::from_array),
            sun: color(self.sun, own.sun),
            shadows: self.shadows.unwrap_or(own.shadows),
            sun_radius: self.sun_radius.unwrap_or(own.sun_radius),
            sky: color(self.sky, own.sky),
            ground: color(self.ground, own.ground),
            zenith: color(self.zenith, own.zenith),
            horizon: color(self.horizon, own.horizon),
        })
    }
}

/// A `kinetarium.Lamp`.
#[derive(FromPyObject)]
struct LampDraft {
    kind: String,
    position: [f64; 3],
    direction: [f64; 3],
    color: [f32; 3],
    attenuation: [f64; 3],
    cutoff: f64,
    exponent: f64,
    body: Option<String>,
    mode: String,
    shadows: bool,
}

impl LampDraft {
    fn lamp(self, row: usize, of: &kinetarium::model::Model) -> PyResult<Lamp> {
        let (cutoff, exponent) = (self.cutoff, self.exponent);
        let kinds: Table<LampKind, 3> = [
            ("point", LampKind::Point),
            ("spot", LampKind::Spot { cutoff, exponent }),
            ("parallel", LampKind::Parallel),
        ];
        let along = DVec3::from_array(self.direction).normalize();
        let turn = DQuat::from_rotation_arc(DVec3::NEG_Z, along);
        let body = self.body.map(|name| of.body(&name).map_err(error::model));
        Ok(Lamp {
            body: body.transpose()?,
            mode: find(&MODES, "mode of lamps", &self.mode)?,
            pose: Pose::new(DVec3::from_array(self.position), turn),
            color: Vec3::from_array(self.color),
            attenuation: DVec3::from_array(self.attenuation),
            shadows: self.shadows,
            ..Lamp::new(
                format!("lamp {row}"),
                find(&kinds, "kind of lamps", &self.kind)?,
            )
        })
    }
}

/// Where images are drawn.
pub fn device(name: &str) -> PyResult<Device> {
    let device = name.parse();
    device.map_err(|e: RenderError| error::raise("DeviceError", e.to_string()))
}

/// How cameras of a model move.
pub const MODES: Table<CameraMode, 2> =
    [("fixed", CameraMode::Fixed), ("track", CameraMode::Track)];

fn channels(names: &[String]) -> PyResult<Channels> {
    let mut channels = Channels::NONE;
    for name in names {
        match name.as_str() {
            "rgb" => channels.rgb = true,
            "depth" => channels.depth = true,
            "body" => channels.body = true,
            "shape" => channels.shape = true,
            "normal" => channels.normal = true,
            other => {
                let known = ["rgb", "depth", "body", "shape", "normal"];
                return Err(unknown("channel", other, &known));
            }
        }
    }
    Ok(channels)
}

/// Images as arrays of the shape (worlds, height, width) or (worlds, height, width, 3), by channel.
pub fn images<'py>(py: Python<'py>, made: Images) -> PyResult<Bound<'py, PyDict>> {
    let pixels = [made.worlds, made.height, made.width];
    let colors = [made.worlds, made.height, made.width, 3];
    let found = PyDict::new(py);
    if let Some(rgb) = made.rgb {
        found.set_item("rgb", rgb.into_pyarray(py).reshape(colors)?)?;
    }
    if let Some(depth) = made.depth {
        found.set_item("depth", depth.into_pyarray(py).reshape(pixels)?)?;
    }
    if let Some(body) = made.body {
        found.set_item("body", body.into_pyarray(py).reshape(pixels)?)?;
    }
    if let Some(shape) = made.shape {
        found.set_item("shape", shape.into_pyarray(py).reshape(pixels)?)?;
    }
    if let Some(normal) = made.normal {
        found.set_item("normal", normal.into_pyarray(py).reshape(colors)?)?;
    }
    Ok(found)
}

/// What is made of the places of the bodies of some worlds, in the simulation's threads: of others, a process that was
/// forked has none.
fn placed<R: Send>(
    py: Python<'_>,
    engine: &Engine,
    worlds: &[i64],
    make: impl FnOnce(Vec<Vec<Pose>>) -> R + Send,
) -> PyResult<R> {
    engine.with(py, |s| {
        each!(s, read, s => {
            let bodies = s.model().bodies.len();
            let parts = (0..bodies).map(|body| OutputPart::Motion(BodyId(body)));
            Ok(s.observe_parts(parts, |_, outputs| {
                let of = |&world: &i64| {
                    let bodies = (0..bodies).map(BodyId);
                    bodies.map(|body| outputs.body_pose(world as usize, body)).collect()
                };
                make(worlds.iter().map(of).collect())
            })?)
        })
    })
}

/// Colours of one world, shape (height, width, 3), as a picture in a file.
#[pyfunction]
pub fn png<'py>(py: Python<'py>, rgb: PyReadonlyArray3<'py, u8>) -> PyResult<Bound<'py, PyBytes>> {
    let (height, width) = (rgb.shape()[0], rgb.shape()[1]);
    let mut file = Vec::new();
    render::write_png(&mut file, slice(&rgb)?, width, height).map_err(failed)?;
    Ok(PyBytes::new(py, &file))
}

/// What a camera sees in some worlds, by channel.
#[pyfunction]
pub fn render_view<'py>(
    py: Python<'py>,
    engine: &Bound<'py, Engine>,
    model: &Bound<'py, Model>,
    view: View,
    worlds: PyReadonlyArray1<'py, i64>,
    device: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let device = self::device(device)?;
    let worlds = worlds.as_array().to_vec();
    let model = model.get();
    let made = placed(py, engine.get(), &worlds, |placed| {
        let poses: Vec<&[Pose]> = placed.iter().map(Vec::as_slice).collect();
        model.renderer(&device)?.render(&view.0, &poses)
    });
    images(py, made?.map_err(failed)?)
}

/// Position [m] and orientation of a free camera that has all bodies of a world in its image.
#[pyfunction]
pub fn framing(
    py: Python<'_>,
    engine: &Bound<'_, Engine>,
    model: &Bound<'_, Model>,
    world: i64,
    width: usize,
    height: usize,
) -> PyResult<([f64; 3], [f64; 4], f64)> {
    let model = model.get();
    let camera = placed(py, engine.get(), &[world], |placed| {
        let renderer = model.renderer(&Device::Processor)?;
        Ok(Camera::framing(renderer.scene(), &placed[0], width, height))
    });
    let camera = camera?.map_err(failed)?;
    let Lens::FieldOfView { vertical } = camera.lens else {
        let message = "a framing camera has a field of view".to_owned();
        return Err(error::raise("RenderError", message));
    };
    let pose = camera.pose;
    Ok((
        pose.position.to_array(),
        pose.orientation.to_array(),
        vertical,
    ))
}

/// Orientation of a camera at `eye` that has `target` in the middle of its image and `up` upwards.
#[pyfunction]
pub fn looking(eye: [f64; 3], target: [f64; 3], up: [f64; 3]) -> [f64; 4] {
    let [eye, target, up] = [eye, target, up].map(DVec3::from_array);
    let camera = Camera::new(1, 1, 1.0).looking(eye, target, up);
    camera.pose.orientation.to_array()
}
