//! What piles ask of the graphics card of the page.

use crate::card::{Bindings, Buffer, Card, Commands, Kernel};
use numbers::trace::{Members, PrintOptions, Program};
use piles::{BINDINGS, Entry, Kind, WORKGROUP, kinds};
use sim::{DeviceError, Stage};
use std::convert::Infallible;
use std::ops::Range;

/// What is asked of the card together. Nothing tells it how long stages take.
#[derive(Debug, Default)]
pub(crate) struct Together(Commands);

impl piles::Commands<Card> for Together {
    fn run(&mut self, kernel: &Kernel, bindings: &Bindings, workgroups: u32) {
        self.0.run(kernel, bindings, workgroups);
    }
    fn run_told(
        &mut self,
        kernel: &Kernel,
        bindings: &Bindings,
        (launches, nth): (&Buffer, u32),
        _: u32,
    ) {
        self.0.run_told(kernel, bindings, launches, nth);
    }
    fn copy(&mut self, from: &Buffer, words: Range<usize>, to: &Buffer, at: usize) {
        self.0.copy(from, words, to, at);
    }
    fn mark(&mut self, _: &'static str) {}
}

impl piles::Card for Card {
    type Buffer = Buffer;
    type Layout = Vec<Kind>;
    type Bindings = Bindings;
    type Kernel = Kernel;
    type Staging = ();
    type Clock = Infallible;
    type Commands<'a> = Together;

    fn name(&self) -> &str {
        &self.name
    }
    fn most_bytes(&self) -> u64 {
        Card::most_bytes(self)
    }
    fn most_invocations(&self) -> u32 {
        self.most_workgroups().saturating_mul(WORKGROUP)
    }
    fn check(&self) -> Result<(), DeviceError> {
        Ok(Card::check(self)?)
    }
    fn failed(&self, reason: &str) -> DeviceError {
        Card::failed(self, reason).into()
    }

    fn buffer(&self, words: u64) -> Result<Buffer, DeviceError> {
        Ok(Card::buffer(self, words as usize)?)
    }
    fn launches(&self, words: u64) -> Result<Buffer, DeviceError> {
        Ok(Card::launches(self, words as usize)?)
    }
    fn uniform(&self, words: &[u32]) -> Result<Buffer, DeviceError> {
        Ok(Card::uniform(self, words)?)
    }
    fn room(buffer: &Buffer) -> u64 {
        buffer.room as u64
    }
    fn write(&self, buffer: &Buffer, from: u64, bytes: &[u8]) -> Result<(), DeviceError> {
        Ok(Card::write(self, buffer, from as usize, bytes)?)
    }

    fn layout(&self, written: usize, read: usize) -> Vec<Kind> {
        kinds(written, read)
    }
    // They are waited for once all have begun.
    fn entries<const N: usize>(
        &self,
        text: &str,
        entries: [Entry; N],
        kinds: &Vec<Kind>,
    ) -> Result<[Kernel; N], DeviceError> {
        let kinds =
            |sees: Vec<u32>| Vec::from_iter(sees.into_iter().map(|at| (at, kinds[at as usize])));
        Ok(self.begin(
            text,
            entries.map(|Entry { name, sees }| (name, kinds(sees))),
        )?)
    }
    fn bind(&self, _: &Vec<Kind>, buffers: &[&Buffer]) -> Bindings {
        Card::bind(self, buffers)
    }
    fn kernel(
        &self,
        program: &Program,
        parameters_per_world: bool,
        members: Members,
    ) -> Result<Kernel, DeviceError> {
        let options = PrintOptions {
            parameters_per_world,
            members,
            ..PrintOptions::default()
        };
        Ok(self.printed(program, &options)?)
    }
    fn bind_kernel(&self, buffers: [&Buffer; BINDINGS]) -> Bindings {
        Card::bind(self, &buffers)
    }

    fn clock(&self) -> Option<Infallible> {
        None
    }
    fn times(clock: Infallible) -> Vec<Stage> {
        match clock {}
    }
    fn commands(&self, _: Option<&mut Infallible>) -> Together {
        Together::default()
    }
    fn submit(&self, Together(commands): Together) -> Result<(), DeviceError> {
        Ok(Card::submit(self, &commands)?)
    }
    fn fetch(
        &self,
        Together(commands): Together,
        (): &mut (),
        buffer: &Buffer,
        ranges: impl Iterator<Item = Range<usize>> + Clone,
        read: impl FnOnce(&[f32]),
    ) -> Result<(), DeviceError> {
        Card::submit(self, &commands)?;
        read(&Card::read(self, buffer, ranges)?);
        Ok(())
    }
}
