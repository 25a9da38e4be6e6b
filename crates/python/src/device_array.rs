//! Numbers in the memory of a CUDA card, which torch, jax and cupy take without a copy: DLPack
//! (<https://dmlc.github.io/dlpack/latest/c_api.html>) and the CUDA array interface
//! (<https://numba.readthedocs.io/en/stable/cuda/cuda_array_interface.html>).

#![allow(unsafe_code)]

use kinetarium::sim;
use pyo3::exceptions::PyBufferError;
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use session::Shared;
use std::ffi::{CStr, c_void};
use std::sync::Arc;

/// Numbers (float32) of all worlds in the memory of a CUDA card.
#[pyclass(frozen, module = "kinetarium._engine")]
pub struct DeviceArray {
    array: sim::DeviceArray,
    /// In numbers.
    shape: Vec<usize>,
    strides: Vec<usize>,
    /// In whose memory they lie.
    owner: Arc<Shared<f32>>,
}

impl DeviceArray {
    /// With as many axes as `shape` has: rows are left out where there is one, numbers where a row has one.
    pub fn new(array: sim::DeviceArray, shape: Vec<usize>, owner: Arc<Shared<f32>>) -> Self {
        let [world, row, number] = array.strides;
        let strides = match shape.len() {
            3 => vec![world, row, number],
            2 if shape[1] == array.shape[1] && array.shape[2] == 1 => vec![world, row],
            2 => vec![world, number],
            _ => vec![world],
        };
        Self {
            array,
            shape,
            strides,
            owner,
        }
    }
}

#[pymethods]
impl DeviceArray {
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.shape)
    }
    #[getter]
    fn __cuda_array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let interface = PyDict::new(py);
        let bytes = self.strides.iter().map(|n| n * size_of::<f32>());
        interface.set_item("version", 3)?;
        interface.set_item("shape", self.shape(py)?)?;
        interface.set_item("strides", PyTuple::new(py, bytes.collect::<Vec<_>>())?)?;
        interface.set_item("typestr", "<f4")?;
        // Never said to be read-only, though outputs are: torch takes no such array.
        interface.set_item("data", (self.array.address.at, false))?;
        // All is done that was asked for: nothing is to be waited for.
        interface.set_item("stream", py.None())?;
        Ok(interface)
    }
    fn __dlpack_device__(&self) -> (i32, usize) {
        (CUDA, self.array.address.card)
    }
    #[pyo3(signature = (*, stream=None, max_version=None, dl_device=None, copy=None))]
    fn __dlpack__<'py>(
        &self,
        py: Python<'py>,
        stream: Option<i64>,
        max_version: Option<(u32, u32)>,
        dl_device: Option<(i32, usize)>,
        copy: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        // Nothing is to be waited for on any stream, and the first version is one that all readers take.
        let _ = (stream, max_version);
        if dl_device.is_some_and(|wanted| wanted != self.__dlpack_device__()) || copy == Some(true)
        {
            return Err(PyBufferError::new_err(
                "numbers on a CUDA card are shared where they are, and not copied: read them instead",
            ));
        }
        Export::capsule(py, self)
    }
    fn __repr__(&self) -> String {
        let (shape, card) = (&self.shape, self.array.address.card);
        format!("DeviceArray(shape={shape:?}, float32, on cuda:{card})")
    }
}

/// `kDLCUDA`.
const CUDA: i32 = 2;
/// `kDLFloat`.
const FLOAT: u8 = 2;
/// A capsule that nobody has taken yet.
const FRESH: &CStr = c"dltensor";

/// `DLTensor`, with `DLDevice` and `DLDataType` in place.
#[repr(C)]
struct Tensor {
    data: *mut c_void,
    device_type: i32,
    device_id: i32,
    ndim: i32,
    code: u8,
    bits: u8,
    lanes: u16,
    shape: *mut i64,
    strides: *mut i64,
    byte_offset: u64,
}

/// `DLManagedTensor`.
#[repr(C)]
struct Managed {
    tensor: Tensor,
    context: *mut c_void,
    deleter: Option<unsafe extern "C" fn(*mut Managed)>,
}

/// What a reader is given, and all that has to last as long as it reads.
#[repr(C)]
struct Export {
    /// First, so that its address is this one's.
    managed: Managed,
    shape: Vec<i64>,
    strides: Vec<i64>,
    _owner: Arc<Shared<f32>>,
}

impl Export {
    fn capsule<'py>(py: Python<'py>, array: &DeviceArray) -> PyResult<Bound<'py, PyAny>> {
        let whole = |numbers: &[usize]| numbers.iter().map(|n| *n as i64).collect();
        let mut export = Box::new(Self {
            managed: Managed {
                tensor: Tensor {
                    data: array.array.address.at as *mut c_void,
                    device_type: CUDA,
                    device_id: array.array.address.card as i32,
                    ndim: array.shape.len() as i32,
                    code: FLOAT,
                    bits: 32,
                    lanes: 1,
                    shape: std::ptr::null_mut(),
                    strides: std::ptr::null_mut(),
                    byte_offset: 0,
                },
                context: std::ptr::null_mut(),
                deleter: Some(delete),
            },
            shape: whole(&array.shape),
            strides: whole(&array.strides),
            _owner: Arc::clone(&array.owner),
        });
        export.managed.tensor.shape = export.shape.as_mut_ptr();
        export.managed.tensor.strides = export.strides.as_mut_ptr();
        let pointer = Box::into_raw(export).cast::<c_void>();
        // Safety: the capsule owns the export until a reader renames it, and Python is attached, as `py` says.
        unsafe {
            let capsule = ffi::PyCapsule_New(pointer, FRESH.as_ptr(), Some(drop_capsule));
            if capsule.is_null() {
                delete(pointer.cast());
            }
            Bound::from_owned_ptr_or_err(py, capsule)
        }
    }
}

/// Frees what [`Export::capsule`] made.
///
/// # Safety
/// `managed` is such a pointer, and nobody uses it any more.
unsafe extern "C" fn delete(managed: *mut Managed) {
    // Safety: as promised; an `Export` begins with its `Managed`.
    drop(unsafe { Box::from_raw(managed.cast::<Export>()) });
}

/// Frees what a capsule holds that nobody has taken.
///
/// # Safety
/// `capsule` is one of [`Export::capsule`], at its end.
unsafe extern "C" fn drop_capsule(capsule: *mut ffi::PyObject) {
    // Safety: a capsule that is still fresh holds what it was made with.
    unsafe {
        if ffi::PyCapsule_IsValid(capsule, FRESH.as_ptr()) == 1 {
            delete(ffi::PyCapsule_GetPointer(capsule, FRESH.as_ptr()).cast());
        }
    }
}
