//! Time on a card, by its own clock.

use crate::memory::Staging;
use crate::{Gpu, GpuError};
use sim::Stage;
use std::iter::once;

/// Most marks until they are read: the most queries of a set.
const MARKS: u32 = wgpu::QUERY_SET_MAX_QUERIES;
/// Bytes of a mark.
const MARK: u64 = wgpu::QUERY_SIZE as u64;

/// What stages of passes take.
#[derive(Debug)]
pub struct Clock {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    staging: Staging,
    /// Which stage ends with each mark that is not yet read, none with the first of a pass; and how many launches it had.
    marks: Vec<(Option<&'static str>, u64)>,
    /// Launches since the last one.
    launches: u64,
    /// What stages have taken so far, in the order in which they were first seen.
    times: Vec<Stage>,
}

impl Clock {
    /// What a card needs for one.
    pub const FEATURES: wgpu::Features =
        wgpu::Features::TIMESTAMP_QUERY.union(wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES);

    /// Of a card that has one.
    pub fn new(gpu: &Gpu) -> Option<Self> {
        let device = gpu.device();
        device.features().contains(Self::FEATURES).then(|| Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: None,
                ty: wgpu::QueryType::Timestamp,
                count: MARKS,
            }),
            resolved: device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: u64::from(MARKS) * MARK,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            staging: Staging::default(),
            marks: Vec::new(),
            launches: 0,
            times: Vec::new(),
        })
    }

    /// What stages have taken.
    pub fn times(self) -> Vec<Stage> {
        self.times
    }

    /// A kernel is launched.
    pub fn launches(&mut self) {
        self.launches += 1;
    }
    /// What was launched in a pass since the mark before belongs to a stage; to none what was before the pass.
    pub fn mark(&mut self, pass: &mut wgpu::ComputePass<'_>, stage: Option<&'static str>) {
        let index = self.marks.len() as u32;
        if index < MARKS {
            pass.write_timestamp(&self.queries, index);
            self.marks.push((stage, std::mem::take(&mut self.launches)));
        }
    }

    /// Reads the marks of what is submitted.
    pub fn read(&mut self, gpu: &Gpu) -> Result<(), GpuError> {
        let marks = std::mem::take(&mut self.marks);
        if marks.is_empty() {
            return Ok(());
        }
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        let range = 0..marks.len() as u32;
        encoder.resolve_query_set(&self.queries, range, &self.resolved, 0);
        let period = f64::from(gpu.queue().get_timestamp_period()) * 1e-9;
        let times = &mut self.times;
        let numbers = once(0..2 * marks.len());
        let staging = &mut self.staging;
        staging.fetch(gpu, encoder, &self.resolved, numbers, |read| {
            let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(read);
            for (mark, ticks) in marks.iter().skip(1).zip(ticks.windows(2)) {
                let ((Some(name), launches), [from, to]) = (*mark, ticks) else {
                    continue;
                };
                let seconds = to.saturating_sub(*from) as f64 * period;
                let stage = Stage {
                    name,
                    seconds,
                    launches,
                };
                stage.add_to(times);
            }
        })
    }
}
