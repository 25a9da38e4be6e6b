//! Every kernel recorded: valid WGSL, and run step by step it keeps the bits.

mod common;
mod shader;

use common::Pair;
use common::world::{MANIFOLD, World, links, state, vertices};
use fastrand::Rng;
use kinetarium_collide::{Route, kind};
use numbers::trace::{self, PrintOptions, Program};
use numbers::{Cpu, Shared};

/// The contact as bits, by the kernel or by its record.
fn contact(world: World, pair: &Pair, record: Option<&Program>) -> Vec<u32> {
    let numbers = |x: Vec<f64>| x.into_iter().map(|x| x as f32).collect::<Vec<_>>();
    let (mut state, parameters, links) =
        (numbers(state(pair)), numbers(vertices(pair)), links(pair));
    let mut output = vec![0f32; MANIFOLD];
    let mut k = Cpu {
        state: &mut state,
        input: &[],
        output: &mut output,
        scratch: &mut vec![0f32; world.scratch],
        parameters: Shared::<f32>(&parameters),
        links: &links,
    };
    match record {
        Some(program) => program.interpret(&mut k).unwrap(),
        None => world.run(&mut k),
    }
    output.iter().map(|x| x.to_bits()).collect()
}

#[test]
fn every_pair_keeps_its_bits_and_prints_as_a_shader() {
    let mut rng = Rng::with_seed(13);
    for a in 0..kind::CONVEX {
        for b in a..kind::CONVEX {
            let Some(route) = Route::of(a, b) else {
                continue;
            };
            let hulls = [a, b].iter().filter(|&&kind| kind == kind::HULL).count();
            let world = World::new(route, 12 * hulls);
            let program = trace::record(|k| world.run(k)).unwrap();
            shader::validate(&program, &PrintOptions::default());
            for _ in 0..50 {
                let pair = Pair::random([a, b], &mut rng);
                let expected = contact(world, &pair, None);
                assert_eq!(contact(world, &pair, Some(&program)), expected, "{pair:#?}");
            }
        }
    }
}
