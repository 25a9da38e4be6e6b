//! Sixteen pairs in lanes have the bits of each pair alone, on every instruction set.

mod common;

use common::world::{MANIFOLD, World, links, state, vertices};
use common::{Pair, Solid};
use fastrand::Rng;
use kinetarium_collide::{Route, kind};
use numbers::dispatch::{Isa, Job, run_block, run_single};
use numbers::{Cpu, Float, Lanes, Memory, Shared};

/// Blocks of pairs for each pair of kinds.
const BLOCKS: usize = 20;

struct Contacts<'a> {
    world: World,
    state: &'a mut [f32],
    output: &'a mut [f32],
    scratch: &'a mut [f32],
    parameters: &'a [f32],
    links: &'a [u32],
}

impl Job for Contacts<'_> {
    type Scalar = f32;
    type Output = ();
    #[inline(always)]
    fn run<R: Lanes<Scalar = f32>>(self) {
        let mut k = Cpu {
            state: bytemuck::cast_slice_mut::<f32, R>(self.state),
            input: &[],
            output: bytemuck::cast_slice_mut(self.output),
            scratch: bytemuck::cast_slice_mut(self.scratch),
            parameters: Shared(self.parameters),
            links: self.links,
        };
        self.world.run(&mut k);
    }
}

/// The contacts of as many pairs as there are lanes, which share their hulls' vertices.
fn contacts(isa: Isa, pairs: &[Pair], route: Route) -> Vec<Vec<u32>> {
    let width = pairs.len();
    let parameters: Vec<f32> = vertices(&pairs[0]).iter().map(|&x| x as f32).collect();
    let links = links(&pairs[0]);
    let world = World::new(route, parameters.len() / 3);
    let mut states = Memory::new(width, 20, width);
    for (i, pair) in pairs.iter().enumerate() {
        for (offset, x) in state(pair).into_iter().enumerate() {
            states.set(i, offset, x as f32);
        }
    }
    let mut output = Memory::new(width, MANIFOLD, width);
    let mut scratch = Memory::new(width, world.scratch, width);
    let job = Contacts {
        world,
        state: states.scalars_mut(),
        output: output.scalars_mut(),
        scratch: scratch.scalars_mut(),
        parameters: &parameters,
        links: &links,
    };
    if width == 1 {
        run_single(isa, job);
    } else {
        run_block(isa, job);
    }
    let bits = |lane| (0..MANIFOLD).map(move |i| (lane, i));
    (0..width)
        .map(|lane| {
            bits(lane)
                .map(|(w, i)| output.get(w, i).to_bits())
                .collect()
        })
        .collect()
}

/// As many pairs as there are lanes, with the same hulls.
fn block(kinds: [usize; 2], rng: &mut Rng) -> Vec<Pair> {
    let hulls = kinds.map(|kind| Solid::random(kind, rng));
    let pair = |_| {
        let mut pair = Pair::random(kinds, rng);
        for i in 0..2 {
            if kinds[i] == kind::HULL {
                pair.solids[i] = hulls[i].clone();
            }
        }
        pair
    };
    (0..f32::BLOCK).map(pair).collect()
}

#[test]
fn every_pair_has_the_same_bits_in_lanes_and_alone() {
    let mut rng = Rng::with_seed(11);
    for a in 0..kind::CONVEX {
        for b in a..kind::CONVEX {
            let Some(route) = Route::of(a, b) else {
                continue;
            };
            for _ in 0..BLOCKS {
                let pairs = block([a, b], &mut rng);
                for isa in Isa::available() {
                    let together = contacts(isa, &pairs, route);
                    for (pair, together) in pairs.iter().zip(together) {
                        let alone = contacts(isa, std::slice::from_ref(pair), route);
                        assert_eq!(alone[0], together, "{isa}: {pair:#?}");
                    }
                }
            }
        }
    }
}
