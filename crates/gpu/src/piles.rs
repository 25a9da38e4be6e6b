//! What piles ask of a card, by wgpu.

use crate::Gpu;
use crate::clock::Clock;
use crate::memory::{Staging, buffer, indirect};
use crate::pipeline::bind_group_layout;
use numbers::trace::{Members, Program};
use piles::{BINDINGS, Card, Entry, Kind, NUMBER, WORKGROUP, kinds};
use sim::{DeviceError, Stage};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::{BindGroup, BindGroupLayout, Buffer, CommandEncoder, ComputePass, ComputePipeline};

/// What kinds of buffers a text binds.
#[derive(Debug)]
pub struct Layout(Vec<Kind>);

/// What is launched.
#[derive(Clone, Debug)]
pub struct Kernel {
    pipeline: ComputePipeline,
    /// Of an entry point of a text; those of records see all that these bind.
    seen: Option<Arc<Seen>>,
}

/// Which of a text's bindings an entry point sees.
#[derive(Debug)]
struct Seen {
    name: &'static str,
    sees: Vec<u32>,
    layout: BindGroupLayout,
}

/// The buffers that launches see.
#[derive(Debug)]
pub enum Bindings {
    /// All of a record.
    All(BindGroup),
    /// Those of a text, of which its entry points see some.
    Some {
        /// Where they are.
        card: Gpu,
        /// All of them.
        buffers: Vec<Buffer>,
        /// What was bound, for which entry points.
        groups: Mutex<HashMap<&'static str, BindGroup>>,
    },
}

impl Bindings {
    /// Those that a kernel sees.
    fn of(&self, kernel: &Kernel) -> BindGroup {
        match (self, &kernel.seen) {
            (Self::All(group), None) => group.clone(),
            (
                Self::Some {
                    card,
                    buffers,
                    groups,
                },
                Some(seen),
            ) => {
                let mut groups = groups.lock().unwrap_or_else(PoisonError::into_inner);
                let group = groups.entry(seen.name).or_insert_with(|| {
                    let some = seen.sees.iter().map(|at| (*at, &buffers[*at as usize]));
                    card.bind(&seen.layout, some)
                });
                group.clone()
            }
            _ => panic!("a kernel is launched with the bindings of another text"),
        }
    }
}

/// What is asked of a card together: copies, and passes between them.
#[derive(Debug)]
pub struct Commands<'a> {
    /// Dropped before what it is a part of.
    pass: Option<ComputePass<'static>>,
    encoder: CommandEncoder,
    clock: Option<&'a mut Clock>,
}

impl<'a> Commands<'a> {
    fn pass(&mut self) -> &mut ComputePass<'static> {
        let (encoder, clock) = (&mut self.encoder, &mut self.clock);
        self.pass.get_or_insert_with(|| {
            let mut pass = encoder
                .begin_compute_pass(&Default::default())
                .forget_lifetime();
            if let Some(clock) = clock {
                clock.mark(&mut pass, None);
            }
            pass
        })
    }
    fn set(&mut self, kernel: &Kernel, bindings: &Bindings) -> &mut ComputePass<'static> {
        self.pass();
        // With the first one of a pass, the pass has begun.
        if let Some(clock) = &mut self.clock {
            clock.launches();
        }
        let pass = self.pass();
        pass.set_pipeline(&kernel.pipeline);
        pass.set_bind_group(0, &bindings.of(kernel), &[]);
        pass
    }
    fn end(mut self) -> (CommandEncoder, Option<&'a mut Clock>) {
        self.pass = None;
        (self.encoder, self.clock)
    }
}

impl piles::Commands<Gpu> for Commands<'_> {
    fn run(&mut self, kernel: &Kernel, bindings: &Bindings, workgroups: u32) {
        self.set(kernel, bindings)
            .dispatch_workgroups(workgroups, 1, 1);
    }
    fn run_told(
        &mut self,
        kernel: &Kernel,
        bindings: &Bindings,
        (launches, nth): (&Buffer, u32),
        _: u32,
    ) {
        let pass = self.set(kernel, bindings);
        pass.dispatch_workgroups_indirect(launches, u64::from(3 * nth) * NUMBER);
    }
    fn copy(&mut self, from: &Buffer, words: Range<usize>, to: &Buffer, at: usize) {
        self.pass = None;
        let [start, size, at] = [words.start, words.len(), at].map(|n| n as u64 * NUMBER);
        self.encoder
            .copy_buffer_to_buffer(from, start, to, at, size);
    }
    fn mark(&mut self, stage: &'static str) {
        if self.clock.is_some() {
            self.pass();
        }
        if let (Some(clock), Some(pass)) = (&mut self.clock, &mut self.pass) {
            clock.mark(pass, Some(stage));
        }
    }
}

impl Card for Gpu {
    type Buffer = Buffer;
    type Layout = Layout;
    type Bindings = Bindings;
    type Kernel = Kernel;
    type Staging = Staging;
    type Clock = Clock;
    type Commands<'a> = Commands<'a>;

    fn name(&self) -> &str {
        Gpu::name(self)
    }
    fn most_bytes(&self) -> u64 {
        Gpu::most_bytes(self)
    }
    fn most_invocations(&self) -> u32 {
        let groups = self.device().limits().max_compute_workgroups_per_dimension;
        groups.saturating_mul(WORKGROUP)
    }
    fn cuts_loops(&self) -> bool {
        Gpu::cuts_loops(self)
    }
    fn check(&self) -> Result<(), DeviceError> {
        Ok(Gpu::check(self)?)
    }
    fn failed(&self, reason: &str) -> DeviceError {
        Gpu::failed(self, reason).into()
    }

    fn buffer(&self, words: u64) -> Result<Buffer, DeviceError> {
        Ok(buffer(self, words)?)
    }
    fn launches(&self, words: u64) -> Result<Buffer, DeviceError> {
        Ok(indirect(self, words)?)
    }
    fn uniform(&self, words: &[u32]) -> Result<Buffer, DeviceError> {
        Ok(Gpu::uniform(self, words))
    }
    fn room(buffer: &Buffer) -> u64 {
        buffer.size() / NUMBER
    }
    fn write(&self, buffer: &Buffer, from: u64, bytes: &[u8]) -> Result<(), DeviceError> {
        self.queue().write_buffer(buffer, from * NUMBER, bytes);
        Ok(())
    }

    fn layout(&self, written: usize, read: usize) -> Layout {
        Layout(kinds(written, read))
    }
    fn entries<const N: usize>(
        &self,
        text: &str,
        entries: [Entry; N],
        Layout(kinds): &Layout,
    ) -> Result<[Kernel; N], DeviceError> {
        let seen = entries.map(|Entry { name, sees }| {
            let some = sees.iter().map(|at| (*at, kinds[*at as usize]));
            let layout = bind_group_layout(self.device(), some);
            Arc::new(Seen { name, sees, layout })
        });
        let named = seen.each_ref().map(|it| (it.name, Some(&it.layout)));
        let pipelines = Gpu::entries(self, text, named)?;
        let mut seen = seen.into_iter();
        Ok(pipelines.map(|pipeline| Kernel {
            pipeline,
            seen: seen.next(),
        }))
    }
    fn bind(&self, _: &Layout, buffers: &[&Buffer]) -> Bindings {
        Bindings::Some {
            card: self.clone(),
            buffers: buffers.iter().copied().cloned().collect(),
            groups: Mutex::default(),
        }
    }
    fn kernel(
        &self,
        program: &Program,
        parameters_per_world: bool,
        members: Members,
    ) -> Result<Kernel, DeviceError> {
        let pipeline = Gpu::kernel(self, program, parameters_per_world, members)?;
        Ok(Kernel {
            pipeline,
            seen: None,
        })
    }
    fn bind_kernel(&self, buffers: [&Buffer; BINDINGS]) -> Bindings {
        Bindings::All(self.bindings(Gpu::layout(self), &buffers))
    }

    fn clock(&self) -> Option<Clock> {
        Clock::new(self)
    }
    fn times(clock: Clock) -> Vec<Stage> {
        clock.times()
    }
    fn commands<'a>(&self, clock: Option<&'a mut Clock>) -> Commands<'a> {
        Commands {
            pass: None,
            encoder: self.device().create_command_encoder(&Default::default()),
            clock,
        }
    }
    fn submit(&self, commands: Commands<'_>) -> Result<(), DeviceError> {
        let (encoder, _) = commands.end();
        self.queue().submit([encoder.finish()]);
        Ok(())
    }
    fn fetch(
        &self,
        commands: Commands<'_>,
        staging: &mut Staging,
        buffer: &Buffer,
        ranges: impl Iterator<Item = Range<usize>> + Clone,
        read: impl FnOnce(&[f32]),
    ) -> Result<(), DeviceError> {
        let (encoder, clock) = commands.end();
        staging.fetch(self, encoder, buffer, ranges, read)?;
        match clock {
            Some(clock) => Ok(clock.read(self)?),
            None => Ok(()),
        }
    }
}
