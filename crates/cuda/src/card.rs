//! A card, ready to compute.

use crate::compiler::{self, CAPABILITY};
use crate::wgsl::{self, Translated};
use crate::{CudaError, libraries};
use cudarc::driver::result::device;
use cudarc::driver::sys::CUresult::{CUDA_ERROR_NO_DEVICE, CUDA_ERROR_OUT_OF_MEMORY};
use cudarc::driver::{
    CudaContext, CudaFunction, CudaModule, CudaSlice, CudaStream, DevicePtr, DeviceRepr,
    DriverError, ValidAsZeroBits,
};
use sim::Address;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// An NVIDIA card. Clones are the same card, and share what was compiled for it.
///
/// Work goes to the card's default stream, after what other libraries of this process asked for there, and before
/// what they ask for next.
#[derive(Clone, Debug)]
pub struct Cuda(Arc<Card>);

#[derive(Debug)]
struct Card {
    stream: Arc<CudaStream>,
    name: String,
    most_bytes: u64,
    /// What was translated, by its WGSL.
    translated: Mutex<HashMap<String, Arc<Translated>>>,
    /// What was compiled, by its text, and the kernels of it that were asked for.
    modules: Mutex<HashMap<String, Module>>,
    /// What went wrong first.
    failure: Mutex<Option<String>>,
}

/// No buffer of piles takes more than this part of a card's memory.
const SHARE: u64 = 16;

/// A text, compiled.
#[derive(Debug)]
struct Module {
    image: Arc<CudaModule>,
    kernels: HashMap<String, CudaFunction>,
}

impl Cuda {
    /// Opens a card, counted from 0 as CUDA counts them (`CUDA_VISIBLE_DEVICES` chooses and orders them).
    ///
    /// # Errors
    /// There is no driver, no compiler, or no such card, with a list of those that there are; it is too old; the driver
    /// refuses.
    pub fn open(ordinal: usize) -> Result<Self, CudaError> {
        Self::open_within(ordinal, u64::MAX)
    }
    /// The same, with kernels of piles that see at most so many bytes of a buffer, as if the card had less memory.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_within(ordinal: usize, most_bytes: u64) -> Result<Self, CudaError> {
        libraries::find_driver()?;
        libraries::find_compiler()?;
        let refused = |e: DriverError| CudaError::Refused {
            card: format!("cuda:{ordinal}"),
            reason: said(e),
        };
        let names = names().map_err(refused)?;
        let Some(name) = names.get(ordinal) else {
            let found = match names.is_empty() {
                true => "none".to_owned(),
                false => names.join(", "),
            };
            return Err(CudaError::NoCard { ordinal, found });
        };
        let context = CudaContext::new(ordinal).map_err(refused)?;
        let found = context.compute_capability().map_err(refused)?;
        if found < CAPABILITY {
            return Err(CudaError::TooOld {
                card: name.clone(),
                found,
                needed: CAPABILITY,
            });
        }
        let memory = context.total_mem().map_err(refused)? as u64;
        let most_bytes = most_bytes.min(memory / SHARE).min(u64::from(u32::MAX) * 4);
        Ok(Self(Arc::new(Card {
            stream: context.default_stream(),
            name: format!("{name} (CUDA)"),
            most_bytes,
            translated: Mutex::default(),
            modules: Mutex::default(),
            failure: Mutex::default(),
        })))
    }
    /// Name of the card.
    pub fn name(&self) -> &str {
        &self.0.name
    }
    /// Most bytes of a buffer that a kernel of piles sees: kernels count words in 32 bits, and there are many buffers.
    pub fn most_bytes(&self) -> u64 {
        self.0.most_bytes
    }
    /// How many kernels are compiled for it so far.
    pub fn compiled(&self) -> usize {
        let modules = lock(&self.0.modules);
        modules.values().map(|module| module.kernels.len()).sum()
    }

    pub(crate) fn stream(&self) -> &Arc<CudaStream> {
        &self.0.stream
    }

    /// Memory for so many numbers, all zero; for one where there are none, as cards have no empty memory.
    pub(crate) fn memory<T: DeviceRepr + ValidAsZeroBits>(
        &self,
        numbers: usize,
    ) -> Result<CudaSlice<T>, CudaError> {
        self.check()?;
        let numbers = numbers.max(1);
        match self.stream().alloc_zeros(numbers) {
            Err(DriverError(CUDA_ERROR_OUT_OF_MEMORY)) => Err(CudaError::Memory {
                bytes: numbers * size_of::<T>(),
                card: self.0.name.clone(),
            }),
            other => self.told(other),
        }
    }
    /// Memory that holds this.
    pub(crate) fn filled<T: DeviceRepr + ValidAsZeroBits>(
        &self,
        numbers: &[T],
    ) -> Result<CudaSlice<T>, CudaError> {
        let mut memory = self.memory(numbers.len())?;
        if !numbers.is_empty() {
            self.told(self.stream().memcpy_htod(numbers, &mut memory))?;
        }
        Ok(memory)
    }

    /// Where numbers lie, once all that was asked for is done: for streams that do not wait for the default one.
    pub(crate) fn address(&self, memory: &CudaSlice<f32>) -> Result<Address, CudaError> {
        self.check()?;
        self.told(self.stream().synchronize())?;
        let (at, _reading) = memory.device_ptr(self.stream());
        Ok(Address {
            card: memory.ordinal(),
            at,
        })
    }

    /// The CUDA C++ of a WGSL text.
    pub(crate) fn translated(&self, text: &str) -> Result<Arc<Translated>, CudaError> {
        if let Some(known) = lock(&self.0.translated).get(text) {
            return Ok(Arc::clone(known));
        }
        let translated = wgsl::to_cuda(text).map_err(|e| CudaError::Read(e.to_string()))?;
        let translated = Arc::new(translated);
        lock(&self.0.translated).insert(text.to_owned(), Arc::clone(&translated));
        Ok(translated)
    }

    /// Compiles a text, or finds what was compiled from it.
    pub(crate) fn function(&self, text: &str, name: &str) -> Result<CudaFunction, CudaError> {
        if let Some(known) = lock(&self.0.modules).get_mut(text) {
            return self.kernel_of(known, name);
        }
        let ptx = compiler::compile(text)?;
        let image = self.loaded(self.stream().context().load_module(ptx))?;
        let mut module = Module {
            image,
            kernels: HashMap::new(),
        };
        let function = self.kernel_of(&mut module, name)?;
        lock(&self.0.modules).insert(text.to_owned(), module);
        Ok(function)
    }
    fn kernel_of(&self, module: &mut Module, name: &str) -> Result<CudaFunction, CudaError> {
        if let Some(known) = module.kernels.get(name) {
            return Ok(known.clone());
        }
        let function = self.loaded(module.image.load_function(name))?;
        module.kernels.insert(name.to_owned(), function.clone());
        Ok(function)
    }
    /// What the driver was to load. What it refuses has changed nothing, unless the card has failed before.
    fn loaded<R>(&self, result: Result<R, DriverError>) -> Result<R, CudaError> {
        result.or_else(|error| {
            self.told(self.stream().synchronize())?;
            Err(CudaError::Load {
                card: self.0.name.clone(),
                reason: said(error),
            })
        })
    }

    /// A result of the driver. A failure stays, as what the card holds may be wrong.
    pub(crate) fn told<R>(&self, result: Result<R, DriverError>) -> Result<R, CudaError> {
        result.map_err(|error| {
            let reason = said(error);
            lock(&self.0.failure).get_or_insert(reason.clone());
            self.failed(reason)
        })
    }
    /// An error if anything has gone wrong.
    pub(crate) fn check(&self) -> Result<(), CudaError> {
        let failure = lock(&self.0.failure).clone();
        failure.map_or(Ok(()), |reason| Err(self.failed(reason)))
    }
    pub(crate) fn failed(&self, reason: String) -> CudaError {
        CudaError::Failed {
            card: self.0.name.clone(),
            reason,
        }
    }
}

/// The names of all cards, in their order.
fn names() -> Result<Vec<String>, DriverError> {
    let count = match CudaContext::device_count() {
        Err(DriverError(CUDA_ERROR_NO_DEVICE)) => 0,
        other => other?,
    };
    (0..count)
        .map(|i| device::get_name(device::get(i)?))
        .collect()
}

/// What the driver says went wrong: its name for it, and its own words where it has any.
fn said(error: DriverError) -> String {
    let words = error.error_string().map(|words| words.to_string_lossy());
    match words {
        Ok(words) => format!("{words} ({:?})", error.0),
        Err(_) => format!("{:?}", error.0),
    }
}

/// Whatever a thread that panicked left, each of these holds whole values.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
