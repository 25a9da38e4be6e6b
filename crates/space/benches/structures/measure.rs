//! Times, and the table they stand in.

use crate::scene::{QUESTIONS, Scene};
use crate::subject::Subject;
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// Work is repeated until this has passed, but at least three times.
const PATIENCE: Duration = Duration::from_millis(300);
/// Questions whose answers are compared.
const ANSWERED: [usize; 5] = [2, 4, 5, 6, 7];
/// What took longer than this with a tenth of the objects is left out.
const HOPELESS: Duration = Duration::from_millis(200);

/// Times of one structure in one scene; nothing where it cannot, or would take for ever.
#[derive(Clone, Copy, Default)]
pub struct Row([Option<Duration>; 8]);

impl Row {
    pub const LEGEND: &str = "\
        build, update, pairs, jump: ms; ray, batch, camera, nearest: µs a question; memory: bytes an object, boxes not included.\n\
        uniform: edges of 0.5 to 1.5 m, 8 m³ of space each. clustered: a hundred boxes in each cluster of some 5 m, edges from\n\
        0.05 to 4.5 m. update: all have moved by up to 2 cm. jump: each has moved to where another was, and pairs are found.\n\
        ray: first hit of a random ray, one by one. batch: the same at once, in threads. camera: rays of a 64 × 64 image at\n\
        once, in threads and lanes; peers: one by one. nearest: the nearest object to a point. pairs: in order, except the\n\
        peers'. –: it cannot, or took more than 0.2 s with a tenth of the objects.";
}

/// Rows as they are measured, one scene after the other.
pub struct Table<'a> {
    /// Part of the names wanted.
    filter: &'a str,
    /// Per structure, its times in the scene before.
    last: HashMap<&'static str, Row>,
    /// The first answers in this scene, per question.
    answers: [Option<usize>; 8],
}

impl<'a> Table<'a> {
    pub fn new(filter: &'a str) -> Self {
        Self {
            filter,
            last: HashMap::new(),
            answers: [None; 8],
        }
    }

    pub fn start(&mut self, scene: &Scene) {
        self.answers = [None; 8];
        println!("\n### {scene}\n");
        println!(
            "| structure | build | update | pairs | jump | ray | batch | camera | nearest | memory |"
        );
        println!("|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|");
    }

    pub fn add<S: Subject>(&mut self, scene: &Scene) {
        if !S::NAME.to_lowercase().contains(self.filter) {
            return;
        }
        let last = self.last.get(S::NAME).copied().unwrap_or_default();
        let mut row = Row::default();
        let mut run = |i: usize, work: &mut dyn FnMut() -> Option<usize>| {
            if last.0[i].is_some_and(|d| d > HOPELESS)
                || (scene.boxes.len() > 100 && last.0[i].is_none())
            {
                return;
            }
            let Some((time, answer)) = median(work) else {
                return;
            };
            row.0[i] = Some(time);
            if ANSWERED.contains(&i) {
                let expected = *self.answers[i].get_or_insert(answer);
                assert_eq!(
                    answer,
                    expected,
                    "{} answers question {i} unlike the first",
                    S::NAME
                );
            }
        };
        run(0, &mut || {
            std::hint::black_box(S::build(scene));
            Some(0)
        });
        let mut subject = S::build(scene);
        run(2, &mut || subject.pairs());
        run(4, &mut || subject.rays(&scene.rays));
        run(5, &mut || subject.ray_batch(&scene.rays));
        run(6, &mut || subject.camera(&scene.camera));
        run(7, &mut || subject.nearest(&scene.points));
        let mut there = false;
        run(1, &mut || {
            there = !there;
            let boxes = if there { &scene.moved } else { &scene.boxes };
            subject.update(boxes).map(|()| 0)
        });
        let _ = subject.update(&scene.boxes);
        there = false;
        run(3, &mut || {
            there = !there;
            let boxes = if there { &scene.jumped } else { &scene.boxes };
            subject.jump(boxes).map(|_| 0)
        });
        let memory = subject.bytes().map(|b| b / scene.boxes.len());
        print(S::NAME, &row, memory);
        self.last.insert(S::NAME, row);
    }
}

fn print(name: &str, row: &Row, memory: Option<usize>) {
    let ms = |i: usize| figure(row.0[i].map(|d| 1e3 * d.as_secs_f64()));
    let us = |i: usize| figure(row.0[i].map(|d| 1e6 * d.as_secs_f64() / QUESTIONS as f64));
    let memory = memory.map_or("–".into(), |m| m.to_string());
    let times = [ms(0), ms(1), ms(2), ms(3), us(4), us(5), us(6), us(7)].join(" | ");
    println!("| {name} | {times} | {memory} |");
}

/// Three digits.
pub fn figure(x: Option<f64>) -> String {
    match x {
        None => "–".into(),
        Some(x) if x >= 100.0 => format!("{x:.0}"),
        Some(x) if x >= 10.0 => format!("{x:.1}"),
        Some(x) if x >= 1.0 => format!("{x:.2}"),
        Some(x) => format!("{x:.3}"),
    }
}

/// The median time of some work, and its last answer.
pub fn median(work: &mut dyn FnMut() -> Option<usize>) -> Option<(Duration, usize)> {
    let begin = Instant::now();
    let mut times = Vec::new();
    let mut answer = 0;
    while times.len() < 3 || (begin.elapsed() < PATIENCE && times.len() < 1000) {
        let start = Instant::now();
        answer = work()?;
        times.push(start.elapsed());
    }
    times.sort();
    Some((times[times.len() / 2], answer))
}
