//! The lane kernels, recorded, do what they do on the CPU, and print as valid WGSL.

use kinetarium_space::{LaneBox, LaneRay};
use numbers::machine::space::{Input, Output};
use numbers::trace::{self, PrintOptions};
use numbers::{Cpu, Machine, Real, Shared, Table, Vec3};

const BOXES: usize = 40;

/// Two boxes and a ray in, two truths and a time out, row by row.
fn kernel<M: Machine>(k: &mut M, questions: Table<Input, 19>, answers: Table<Output, 3>) {
    for i in k.count(BOXES) {
        let a = LaneBox::read(k.read(questions, i, 0));
        let b = LaneBox::read(k.read(questions, i, 6));
        let [x, y, z, u, v, w, limit] = k.read(questions, i, 12);
        let ray = LaneRay::new(Vec3::new(x, y, z), Vec3::new(u, v, w));
        let (time, met) = ray.enter(&a, limit);
        let truth = |mask| M::R::select(mask, M::R::one(), M::R::zero());
        let near = a.is_near(&b, M::R::lit(0.125));
        k.write(answers, i, 0, [truth(near), truth(met), time]);
    }
}

fn cpu<'a>(input: &'a [f32], output: &'a mut [f32]) -> Cpu<'a, f32, Shared<'a, f32>> {
    let (state, scratch) = (&mut [], &mut []);
    Cpu {
        state,
        input,
        output,
        scratch,
        parameters: Shared(&[]),
        links: &[],
    }
}

#[test]
fn lanes_trace() {
    let mut end = 0;
    let questions = Table::<Input, 19>::place(&mut end, BOXES);
    let answers = Table::<Output, 3>::place(&mut 0, BOXES);
    let mut random = fastrand::Rng::with_seed(1);
    let mut input: Vec<f32> = (0..end)
        .map(|_| (random.u8(0..40) as f32 - 20.0) / 8.0)
        .collect();
    for row in input.chunks_mut(19) {
        for axis in 0..3 {
            row[3 + axis] = row[axis] + row[3 + axis].abs();
            row[9 + axis] = row[6 + axis] + row[9 + axis].abs();
        }
        // Some rays rest along an axis, on the face of a box.
        (row[12], row[15]) = if row[15] < 0.0 {
            (row[0], 0.0)
        } else {
            (row[12], row[15])
        };
        row[18] = 10.0;
    }
    let (mut expected, mut found) = (vec![0.0_f32; 3 * BOXES], vec![0.0_f32; 3 * BOXES]);
    kernel(&mut cpu(&input, &mut expected), questions, answers);
    let program = trace::record(|k| kernel(k, questions, answers)).unwrap();
    program.interpret(&mut cpu(&input, &mut found)).unwrap();
    let bits = |numbers: &[f32]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<u32>>();
    assert_eq!(bits(&expected), bits(&found));
    for column in 0..2 {
        let truths = expected.chunks(3).filter(|row| row[column] == 1.0).count();
        assert!(
            (3..BOXES - 3).contains(&truths),
            "both truths occur: {truths}"
        );
    }

    let shader = program.to_wgsl(&PrintOptions::default()).unwrap();
    let module = naga::front::wgsl::parse_str(&shader).unwrap();
    let (flags, capabilities) = (
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::default(),
    );
    naga::valid::Validator::new(flags, capabilities)
        .validate(&module)
        .unwrap();
}
