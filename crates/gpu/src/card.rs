//! A card, ready to compute.

use crate::clock::Clock;
use crate::pipeline::bind_group_layout;
use crate::{Choice, GpuError};
use piles::KINDS;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A graphics card. Clones are the same card, and share what was compiled for it.
#[derive(Clone, Debug)]
pub struct Gpu(Arc<Card>);

/// By text and entry points.
pub(crate) type Pipelines = HashMap<(String, String), Vec<wgpu::ComputePipeline>>;

#[derive(Debug)]
struct Card {
    device: wgpu::Device,
    queue: wgpu::Queue,
    name: String,
    rounds: usize,
    layout: wgpu::BindGroupLayout,
    /// What was compiled, by its text and entry points.
    pipelines: Mutex<Pipelines>,
    /// What went wrong first, which cards tell late.
    failure: Arc<Mutex<Option<String>>>,
}

/// Storage buffers that a kernel may see: as few as WebGPU warrants.
const STORAGE_BUFFERS: u32 = 8;
/// Substeps of one launch: many, as a launch costs some microseconds, and few enough that a card that also
/// draws a desktop is not taken for hung.
const ROUNDS: usize = 16;
/// The same of a program that stands in for a card. Mesa's llvmpipe ends all loops of an invocation, and says nothing,
/// once they have gone round 65,535 times together (`LP_MAX_TGSI_LOOP_ITERATIONS`).
const ROUNDS_OF_PROGRAMS: usize = 1;

impl Gpu {
    /// Opens a card, with all that it is able to take.
    ///
    /// # Errors
    /// There is no such card, with a list of those that there are; or it refuses.
    pub fn open(choice: &Choice) -> Result<Self, GpuError> {
        Self::open_within(choice, u64::MAX)
    }
    /// The same, with kernels that see at most so many bytes of a buffer, as those of lesser cards do.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_within(choice: &Choice, most_bytes: u64) -> Result<Self, GpuError> {
        let adapter = choice.adapter()?;
        let mut limits = adapter.limits();
        limits.max_storage_buffer_binding_size =
            limits.max_storage_buffer_binding_size.min(most_bytes);
        // No kernel sees more, so that all run in browsers, too.
        limits.max_storage_buffers_per_shader_stage = STORAGE_BUFFERS;
        let descriptor = wgpu::DeviceDescriptor {
            required_features: adapter.features() & Clock::FEATURES,
            required_limits: limits,
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))?;
        let failure = Arc::new(Mutex::new(None));
        let note = |failure: &Arc<Mutex<Option<String>>>| {
            let failure = Arc::clone(failure);
            move |what: String| {
                lock(&failure).get_or_insert(what);
            }
        };
        let (wrong, gone) = (note(&failure), note(&failure));
        device.on_uncaptured_error(Arc::new(move |e: wgpu::Error| wrong(e.to_string())));
        device.set_device_lost_callback(move |why, message| {
            gone(format!("it is lost ({why:?}): {message}"));
        });
        let info = adapter.get_info();
        let name = format!("{} ({})", info.name, info.backend);
        let layout = layout(&device);
        let rounds = match info.device_type {
            wgpu::DeviceType::Cpu => ROUNDS_OF_PROGRAMS,
            _ => ROUNDS,
        };
        Ok(Self(Arc::new(Card {
            device,
            queue,
            name,
            rounds,
            layout,
            pipelines: Mutex::default(),
            failure,
        })))
    }

    /// Name of the card, and of what drives it.
    pub fn name(&self) -> &str {
        &self.0.name
    }
    /// Most bytes of a buffer that a kernel sees.
    pub fn most_bytes(&self) -> u64 {
        let limits = self.0.device.limits();
        limits
            .max_storage_buffer_binding_size
            .min(limits.max_buffer_size)
    }
    /// How many kernels are compiled for it so far.
    pub fn compiled(&self) -> usize {
        lock(&self.0.pipelines).values().map(Vec::len).sum()
    }

    /// Most substeps of one launch.
    pub(crate) fn rounds(&self) -> usize {
        self.0.rounds
    }
    /// Whether it ends loops that go round too often.
    pub(crate) fn cuts_loops(&self) -> bool {
        self.0.rounds == ROUNDS_OF_PROGRAMS
    }
    pub(crate) fn device(&self) -> &wgpu::Device {
        &self.0.device
    }
    pub(crate) fn queue(&self) -> &wgpu::Queue {
        &self.0.queue
    }
    pub(crate) fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.0.layout
    }
    pub(crate) fn pipelines(&self) -> MutexGuard<'_, Pipelines> {
        lock(&self.0.pipelines)
    }

    /// What a card says failed.
    pub(crate) fn failed(&self, reason: impl ToString) -> GpuError {
        GpuError::Failed {
            card: self.0.name.clone(),
            reason: reason.to_string(),
        }
    }
    /// An error if anything has gone wrong; it stays, as what the card holds may be wrong.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        let failure = lock(&self.0.failure).clone();
        failure.map_or(Ok(()), |reason| Err(self.failed(reason)))
    }
    /// Waits until all that was asked of the card is done.
    pub(crate) fn wait(&self) -> Result<(), GpuError> {
        let waited = self.0.device.poll(wgpu::PollType::wait_indefinitely());
        waited.map_err(|e| self.failed(e))?;
        self.check()
    }
    /// An error of one sort that some calls met.
    pub(crate) fn scoped<R>(
        &self,
        filter: wgpu::ErrorFilter,
        calls: impl FnOnce() -> R,
    ) -> (R, Option<wgpu::Error>) {
        let scope = self.0.device.push_error_scope(filter);
        let result = calls();
        (result, pollster::block_on(scope.pop()))
    }
}

/// Whatever a thread that panicked left, each of these holds whole values.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What kernels of records bind.
fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    bind_group_layout(device, (0..).zip(KINDS))
}
