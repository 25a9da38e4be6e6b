//! Piles of free bodies in Kinetarium and in Rapier, turn about in one run.
//!
//! ```text
//! kinetarium-bench-rapier [SCENE] [--rounds N] [--only-rapier]
//! ```
//!
//! measures the scenes whose names contain SCENE, all of them if none is named, and prints a table in
//! Markdown. `--only-rapier` leaves Kinetarium out.

#![forbid(unsafe_code)]

mod contest;
mod engine;
mod ours;
mod peer;
mod scene;
mod table;

use contest::Contest;
use engine::Outcome;
use scene::{SCENES, Scene};
use std::process::ExitCode;

const DEFAULT_ROUNDS: usize = 10;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[String]) -> Outcome<()> {
    let Wishes {
        scenes,
        rounds,
        only_rapier,
    } = Wishes::read(arguments)?;
    let (mut rows, mut rows_at_rest) = (Vec::new(), Vec::new());
    for scene in scenes {
        for threads in [1, 2] {
            eprintln!("{} on {threads} threads", scene.name);
            let model = (scene.make)()?;
            let mut contest = Contest::new(&model, threads, only_rapier)?;
            let results = contest.run(rounds, scene.steps, &scene.tops(&model)?)?;
            rows.extend(table::rows(scene, threads, &results));
            if scene.rests && !only_rapier {
                let measured = contest::at_rest(&model, threads, rounds, scene.steps)?;
                rows_at_rest.push(table::row_at_rest(scene, threads, &measured));
            }
        }
    }
    println!("{}", table::heading());
    for row in rows {
        println!("{row}");
    }
    println!("\n{}", table::conditions(rounds));
    if !rows_at_rest.is_empty() {
        println!("\n{}", table::heading_at_rest());
        println!("{}", rows_at_rest.join("\n"));
        println!("\n{}", table::conditions_at_rest());
    }
    Ok(())
}

/// What the command line asks for.
struct Wishes {
    scenes: Vec<&'static Scene>,
    rounds: usize,
    only_rapier: bool,
}

impl Wishes {
    fn read(arguments: &[String]) -> Outcome<Self> {
        let (mut name, mut rounds, mut only_rapier) = ("", DEFAULT_ROUNDS, false);
        let mut rest = arguments.iter().map(String::as_str);
        while let Some(argument) = rest.next() {
            match argument {
                "--rounds" => rounds = rest.next().ok_or("--rounds needs a number")?.parse()?,
                "--only-rapier" => only_rapier = true,
                option if option.starts_with('-') => {
                    return Err(format!(
                        "unknown option `{option}`; known are --rounds N and --only-rapier"
                    )
                    .into());
                }
                word => name = word,
            }
        }
        if rounds < contest::FEWEST_ROUNDS {
            return Err(format!("at least {} rounds are needed", contest::FEWEST_ROUNDS).into());
        }
        let scenes: Vec<_> = SCENES.iter().filter(|s| s.name.contains(name)).collect();
        if scenes.is_empty() {
            let known = SCENES.each_ref().map(|s| s.name).join(", ");
            return Err(format!("no scene is called `{name}`; known are {known}").into());
        }
        Ok(Self {
            scenes,
            rounds,
            only_rapier,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(line: &str) -> Outcome<Wishes> {
        let words: Vec<String> = line.split_whitespace().map(String::from).collect();
        Wishes::read(&words)
    }

    #[test]
    fn a_name_picks_scenes_and_rounds_are_counted() {
        let wishes = read("bowl --rounds 7").unwrap();
        assert_eq!((wishes.scenes.len(), wishes.rounds), (3, 7));
        assert_eq!(read("").unwrap().scenes.len(), SCENES.len());
        assert!(read("--only-rapier").unwrap().only_rapier);
        for wrong in ["towre", "--rounds", "--rounds two", "--rounds 1", "--fast"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
