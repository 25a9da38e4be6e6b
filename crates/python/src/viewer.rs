//! A page about a simulation that Python steps; the program `kinetarium`.

use crate::error;
use crate::simulation::{Engine, Precise};
use crate::skin::{self, Skin};
use pyo3::prelude::*;
use std::ffi::OsString;
use std::net::SocketAddr;
use std::sync::Mutex;

/// A page about a simulation, served in the background until it is closed or the simulation is gone.
#[pyclass(frozen, module = "kinetarium._engine")]
pub struct Viewer {
    viewer: Mutex<Option<viewer::Viewer>>,
    url: String,
}

#[pymethods]
impl Viewer {
    /// Where the page is, with its token where there is one.
    #[getter]
    fn url(&self) -> &str {
        &self.url
    }
    /// Whether it still serves.
    #[getter]
    fn is_open(&self) -> bool {
        let viewer = self.viewer.lock().unwrap_or_else(|e| e.into_inner());
        viewer.as_ref().is_some_and(viewer::Viewer::is_open)
    }
    /// Has bodies wear a skin, by their names; without names, all of them.
    #[pyo3(signature = (bodies, skin))]
    fn dress(&self, bodies: Option<Vec<String>>, skin: &Skin) -> PyResult<()> {
        let viewer = self.viewer.lock().unwrap_or_else(|e| e.into_inner());
        let Some(viewer) = viewer.as_ref().filter(|viewer| viewer.is_open()) else {
            let message = "the page is closed: open it anew by Simulation.view";
            return Err(error::raise("ViewerError", message.into()));
        };
        let skin = skin.0.clone();
        let dressed = match bodies {
            Some(bodies) => viewer.dress(&bodies, skin),
            None => viewer.dress_all(skin),
        };
        dressed.map_err(skin::raise)
    }
    /// Stops serving.
    fn close(&self, py: Python<'_>) {
        py.detach(|| {
            let viewer = self.viewer.lock().unwrap_or_else(|e| e.into_inner()).take();
            if let Some(viewer) = viewer {
                viewer.close();
            }
        });
    }
}

/// Serves a page about a simulation at an address, or at any free port of the loopback address.
#[pyfunction]
#[pyo3(signature = (engine, address=None, token=None))]
pub fn show(
    py: Python<'_>,
    engine: &Bound<'_, Engine>,
    address: Option<&str>,
    token: Option<&str>,
) -> PyResult<Viewer> {
    let address = address.map(|at| {
        at.parse::<SocketAddr>().map_err(|e| {
            let message = format!("the address \"{at}\" is none ({e}): give one as 127.0.0.1:7357");
            error::raise("ViewerError", message)
        })
    });
    let address = address.transpose()?;
    let shown = engine.get().attempt(py, |s| {
        let shown = match s {
            Precise::Single(s) => viewer::show(s, address, token),
            Precise::Double(s) => viewer::show(s, address, token),
        };
        shown.map_err(|e| error::raise("ViewerError", e.to_string()))
    })?;
    Ok(Viewer {
        url: shown.url().to_owned(),
        viewer: Mutex::new(Some(shown)),
    })
}

/// The program `kinetarium` with a command line, its name first; returns its exit code.
#[pyfunction]
pub fn run_program(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| cli::run_program(arguments))
}
