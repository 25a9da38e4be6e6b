//! What sensors carry along, as bytes.
//!
//! Little-endian:
//!
//! ```text
//! magic            8 bytes, "KNTRMSNS"
//! version          u32
//! fingerprint      u64, of precision, worlds, seed, and each sensor's name, kind, part, rate, cutoff and noise
//! worlds           each: u32, how often it has begun anew
//! sensors          each, of every world: u64 last sample + 1, or 0; f64 its time [s]; then biases that
//!                  wander (f64), numbers, and images (rgb u8; depth, normal f32; body, shape i32)
//! checksum         u32, CRC-32 of all before
//! ```

use crate::SensorError;
use crate::sensors::{Channel, Sampled, Sensors, World};
use numbers::Float;
use render::Images;

const MAGIC: [u8; 8] = *b"KNTRMSNS";
const VERSION: u32 = 1;
const CHECKSUM: usize = 4;

impl<T: Float> Sensors<T> {
    /// What the sensors carry along: samples taken, biases that wander, readings and images. With a
    /// [`Snapshot`](sim::Snapshot) of the simulation, both go on as they would have.
    pub fn save(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(self.fingerprint().to_le_bytes());
        for world in &self.worlds {
            bytes.extend(world.episode.to_le_bytes());
        }
        for channel in &self.channels {
            write(channel, &mut bytes);
        }
        let checksum = crc32fast::hash(&bytes);
        bytes.extend(checksum.to_le_bytes());
        bytes
    }

    /// Returns to what [`save`](Self::save) gave, by sensors made alike. The simulation is to be restored as
    /// well, before the next [`update`](Self::update) or [`step`](Self::step).
    ///
    /// # Errors
    /// The bytes are damaged, or of other sensors, another seed, precision or number of worlds; the sensors
    /// are as before.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), SensorError> {
        let content = self.checked(bytes)?;
        let mut reader = Reader(&content[MAGIC.len() + 12..]);
        for world in &mut self.worlds {
            *world = World::new(u32::from_le_bytes(reader.take()));
        }
        for channel in &mut self.channels {
            read(channel, &mut reader);
        }
        Ok(())
    }

    /// The bytes before the checksum, if they are of these sensors.
    fn checked<'a>(&self, bytes: &'a [u8]) -> Result<&'a [u8], SensorError> {
        let refuse = |why| Err(SensorError::State(why));
        if !bytes.starts_with(&MAGIC) {
            return refuse("it does not start with `KNTRMSNS`; give what `save` gave");
        }
        let damaged = "it is cut off or damaged; copy it again";
        let Some((content, checksum)) = bytes.split_last_chunk::<CHECKSUM>() else {
            return refuse(damaged);
        };
        if crc32fast::hash(content).to_le_bytes() != *checksum || content.len() < 20 {
            return refuse(damaged);
        }
        let mut reader = Reader(&content[MAGIC.len()..]);
        if u32::from_le_bytes(reader.take()) != VERSION {
            return refuse("another release wrote it; update Kinetarium, or save anew");
        }
        if u64::from_le_bytes(reader.take()) != self.fingerprint() {
            return refuse(
                "it is of other sensors, another seed, precision or number of worlds; make sensors as \
                 those it was saved from",
            );
        }
        if reader.0.len() != self.length() {
            return refuse(damaged);
        }
        Ok(content)
    }

    /// Bytes of worlds and sensors.
    fn length(&self) -> usize {
        let of = |c: &Channel<T>| {
            let images = c.camera.as_ref().map_or(0, |camera| size(&camera.images));
            16 * c.samples.len() + 8 * c.walk.len() + size_of::<T>() * c.numbers.len() + images
        };
        4 * self.worlds.len() + self.channels.iter().map(of).sum::<usize>()
    }

    /// FNV-1a (Fowler, Noll, Vo) over all that a state must agree on.
    fn fingerprint(&self) -> u64 {
        let head = format!("{} {} {}", size_of::<T>(), self.worlds.len(), self.seed);
        let sensors = self.sensors().map(|sensor| format!("{sensor:?}"));
        let text = std::iter::once(head).chain(sensors).collect::<String>();
        text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
    }
}

/// Bytes, taken from the front; [`Sensors::checked`] has seen that there are enough.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (taken, rest) = self.0.split_at(N);
        self.0 = rest;
        let mut bytes = [0; N];
        bytes.copy_from_slice(taken);
        bytes
    }
    fn float(&mut self) -> f64 {
        f64::from_le_bytes(self.take())
    }
}

fn write<T: Float>(channel: &Channel<T>, bytes: &mut Vec<u8>) {
    for (sampled, time) in channel.samples.iter().zip(&channel.time) {
        let last = sampled.last.map_or(0, |last| last + 1);
        bytes.extend(last.to_le_bytes());
        bytes.extend(time.to_le_bytes());
    }
    bytes.extend(channel.walk.iter().flat_map(|x| x.to_le_bytes()));
    for x in &channel.numbers {
        if T::DOUBLE {
            bytes.extend(x.to_f64().to_le_bytes());
        } else {
            bytes.extend((x.to_f64() as f32).to_le_bytes());
        }
    }
    if let Some(camera) = &channel.camera {
        let images = &camera.images;
        bytes.extend(images.rgb.iter().flatten());
        for x in images.depth.iter().chain(&images.normal).flatten() {
            bytes.extend(x.to_le_bytes());
        }
        for x in images.body.iter().chain(&images.shape).flatten() {
            bytes.extend(x.to_le_bytes());
        }
    }
}

fn read<T: Float>(channel: &mut Channel<T>, bytes: &mut Reader<'_>) {
    for (sampled, time) in channel.samples.iter_mut().zip(&mut channel.time) {
        *sampled = Sampled::default();
        sampled.last = u64::from_le_bytes(bytes.take()).checked_sub(1);
        *time = bytes.float();
    }
    channel.walk.fill_with(|| bytes.float());
    channel.numbers.fill_with(|| {
        T::from_f64(if T::DOUBLE {
            bytes.float()
        } else {
            f32::from_le_bytes(bytes.take()).into()
        })
    });
    if let Some(camera) = &mut channel.camera {
        let images = &mut camera.images;
        for x in images.rgb.iter_mut().flatten() {
            [*x] = bytes.take();
        }
        for x in images.depth.iter_mut().chain(&mut images.normal).flatten() {
            *x = f32::from_le_bytes(bytes.take());
        }
        for x in images.body.iter_mut().chain(&mut images.shape).flatten() {
            *x = i32::from_le_bytes(bytes.take());
        }
    }
}

/// Bytes of all images.
fn size(images: &Images) -> usize {
    let words = images.depth.iter().chain(&images.normal).map(Vec::len);
    let rows = images.body.iter().chain(&images.shape).map(Vec::len);
    let rgb = images.rgb.as_ref().map_or(0, Vec::len);
    rgb + 4 * words.chain(rows).sum::<usize>()
}
