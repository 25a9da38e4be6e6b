//! What changes from frame to frame, as bytes.
//!
//! Little-endian; everything is four bytes wide but the time, and starts at a multiple of four:
//!
//! | offset | type | what |
//! |---|---|---|
//! | 0 | u32 | [`MAGIC`] |
//! | 4 | u32 | [`Scene::id`](crate::protocol::Scene::id) |
//! | 8 | u32 | number of the frame, from 0 |
//! | 12 | u32 | bit 0: running; above: how often other worlds were chosen to be shown, modulo 2³¹ |
//! | 16 | f64 | time [s] since the start |
//! | 24 | u32 | steps since the start, modulo 2³² |
//! | 28 | u32 | W, worlds shown |
//! | 32 | u32 | B, bodies |
//! | 36 | u32 | C, contacts of all worlds shown |
//! | 40 | u32 | J, joint coordinates of the first world shown |
//! | 44 | u32 | D, degrees of freedom |
//! | 48 | u32 | Q, plotted quantities |
//! | 52 | u32 | P, particles of all worlds shown |
//! | 56 | u32 | S, earlier samples of the plotted quantities, since the frame before |
//! | 60 | f32 × 7 × W × B | position [m] and orientation x, y, z, w of each body's frame, world by world |
//! | | f32 × 10 × C | row of its world among those shown, position [m], force [N] on the second shape, distance [m], the two shapes |
//! | | f32 × J | joint coordinates |
//! | | f32 × D | joint velocities |
//! | | f32 × Q | values of the plotted quantities |
//! | | f32 × 3 × P | positions of particles [m] |
//! | | f32 × (1 + Q) × S | how long before this frame a sample was taken [s], and the values, in order of time |

/// The first four bytes: `KFRM`.
pub const MAGIC: u32 = u32::from_le_bytes(*b"KFRM");
/// Length of what every frame begins with [bytes].
pub const HEADER: usize = 60;

/// What a frame says, but for its first numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// As in [`Scene::id`](crate::protocol::Scene::id).
    pub scene: u32,
    /// From 0.
    pub number: u32,
    /// Whether the session goes on by itself.
    pub running: bool,
    /// How often other worlds were chosen to be shown.
    pub choices: u32,
    /// [s] since the start.
    pub time: f64,
    /// Since the start.
    pub steps: u32,
    /// Number of worlds.
    pub worlds: u32,
    /// Number of bodies of a world.
    pub bodies: u32,
    /// Seven numbers for each body of each world.
    pub poses: Vec<f32>,
    /// Ten numbers for each contact.
    pub contacts: Vec<f32>,
    /// Joint coordinates of the first world.
    pub positions: Vec<f32>,
    /// Joint velocities of the first world.
    pub velocities: Vec<f32>,
    /// Values of the plotted quantities.
    pub plots: Vec<f32>,
    /// Three numbers for each particle.
    pub particles: Vec<f32>,
    /// For each earlier sample of the plotted quantities: its age [s], and their values.
    pub past: Vec<f32>,
}

/// [`Frame::scene`] of a frame as bytes; none where they are no frame.
pub fn scene_of(bytes: &[u8]) -> Option<u32> {
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    (word(0)? == MAGIC).then(|| word(4))?
}

/// Numbers of a contact.
pub const CONTACT: usize = 10;

impl Frame {
    /// Its bytes, as the table above says.
    pub fn to_bytes(&self) -> Vec<u8> {
        let lists = [
            &self.poses,
            &self.contacts,
            &self.positions,
            &self.velocities,
            &self.plots,
            &self.particles,
            &self.past,
        ];
        let numbers: usize = lists.iter().map(|list| list.len()).sum();
        let mut bytes = Vec::with_capacity(HEADER + 4 * numbers);
        let flags = u32::from(self.running) | self.choices << 1;
        let head = [MAGIC, self.scene, self.number, flags];
        bytes.extend(head.iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend(self.time.to_le_bytes());
        let counts = [
            self.steps,
            self.worlds,
            self.bodies,
            (self.contacts.len() / CONTACT) as u32,
            self.positions.len() as u32,
            self.velocities.len() as u32,
            self.plots.len() as u32,
            (self.particles.len() / 3) as u32,
            (self.past.len() / (1 + self.plots.len())) as u32,
        ];
        bytes.extend(counts.iter().flat_map(|x| x.to_le_bytes()));
        for list in lists {
            bytes.extend(list.iter().flat_map(|x| x.to_le_bytes()));
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_lies_as_the_table_says() {
        let frame = Frame {
            scene: 3,
            number: 7,
            running: true,
            choices: 5,
            time: 1.5,
            steps: 750,
            worlds: 1,
            bodies: 1,
            poses: vec![1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0],
            contacts: vec![0.5; 2 * CONTACT],
            plots: vec![9.0],
            past: vec![0.1, 8.0],
            ..Frame::default()
        };
        let bytes = frame.to_bytes();
        assert_eq!(bytes.len(), HEADER + 4 * (7 + 2 * CONTACT + 1 + 2));
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        assert_eq!(&bytes[..4], b"KFRM");
        assert_eq!(scene_of(&bytes), Some(3));
        assert_eq!([&bytes[..6], &bytes[1..]].map(scene_of), [None; 2]);
        assert_eq!([4, 8, 12, 24].map(word), [3, 7, 11, 750]);
        assert_eq!(bytes[16..24], 1.5_f64.to_le_bytes());
        assert_eq!(
            [28, 32, 36, 40, 44, 48, 52, 56].map(word),
            [1, 1, 2, 0, 0, 1, 0, 1]
        );
        assert_eq!(word(HEADER + 8), 3.0_f32.to_bits());
        assert_eq!(word(bytes.len() - 12), 9.0_f32.to_bits());
    }
}
