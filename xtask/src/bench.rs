//! `cargo xtask bench`: Kinetarium and its peers, turn about in one run, into the tables of BENCHMARKS.md.
//!
//! Kinetarium and MuJoCo each read `target/bench/cases.json`, run every case once, and print one
//! [`Record`] a line. Kinetarium and Rapier are both in Rust, and in one program, which prints a table.

use std::fmt::Write;

use anyhow::{Context, Result, bail, ensure};
use serde::Deserialize;
use xshell::cmd;

use crate::workshop::Workshop;

pub const DEFAULT_REPETITIONS: usize = 5;
const REPORT: &str = "BENCHMARKS.md";
/// Instead of the flags in `.cargo/config.toml`, which are chosen for Kinetarium.
const PEER_FLAGS: &str = "-C target-cpu=native";
const TABLES_END: &str = "<!-- to here -->";

/// What one engine measured in one case, once.
#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Record {
    /// World-steps per second, and an error: the distance of a chain's tip from its reference after
    /// one second [m]; of a robot that touches the ground, the difference of its joints from those of
    /// finer steps [m and rad].
    Speed {
        case: String,
        method: String,
        worlds: u32,
        threads: u32,
        steps_per_second: f64,
        error: Option<f64>,
    },
    /// From the file to the end of the first step [s].
    Load { case: String, seconds: f64 },
    /// State of one world [byte].
    Memory { case: String, bytes: f64 },
}

/// Two measurements that belong side by side, and the ratio aimed at.
struct Comparison {
    case: &'static str,
    worlds: u32,
    ours: &'static str,
    theirs: &'static str,
    goal: Option<f64>,
}

const BATCH: u32 = 4096;
/// Threads of a batch.
const THREADS: u32 = 2;
/// How many times as fast a batch is to be on two threads as on one.
const SHARED: f64 = 1.9;

#[rustfmt::skip]
const COMPARISONS: [Comparison; 17] = [
    Comparison { case: "chain_10", worlds: BATCH, ours: "euler",  theirs: "euler", goal: Some(24.0) },
    Comparison { case: "chain_10", worlds: BATCH, ours: "rk4",    theirs: "rk4",   goal: None },
    Comparison { case: "chain_10", worlds: BATCH, ours: "xpbd_4", theirs: "euler", goal: None },
    Comparison { case: "chain_10", worlds: 1,     ours: "euler",  theirs: "euler", goal: Some(1.5) },
    Comparison { case: "chain_30", worlds: BATCH, ours: "euler",  theirs: "euler", goal: Some(18.0) },
    Comparison { case: "chain_30", worlds: BATCH, ours: "rk4",    theirs: "rk4",   goal: None },
    Comparison { case: "chain_30", worlds: BATCH, ours: "xpbd_4", theirs: "euler", goal: Some(4.5) },
    Comparison { case: "chain_30", worlds: 1,     ours: "euler",  theirs: "euler", goal: Some(1.5) },
    Comparison { case: "humanoid", worlds: BATCH, ours: "euler",  theirs: "euler", goal: Some(40.0) },
    Comparison { case: "humanoid", worlds: BATCH, ours: "xpbd_4", theirs: "euler", goal: None },
    Comparison { case: "humanoid", worlds: 1,     ours: "euler",  theirs: "euler", goal: Some(4.0) },
    Comparison { case: "humanoid, limits", worlds: BATCH, ours: "euler", theirs: "euler", goal: None },
    Comparison { case: "humanoid, limits", worlds: 1,     ours: "euler", theirs: "euler", goal: None },
    Comparison { case: "humanoid on the ground", worlds: BATCH, ours: "euler", theirs: "euler", goal: Some(40.0) },
    Comparison { case: "humanoid on the ground", worlds: 1,     ours: "euler", theirs: "euler", goal: Some(4.0) },
    Comparison { case: "humanoid, all contacts", worlds: BATCH, ours: "euler", theirs: "euler", goal: Some(20.0) },
    Comparison { case: "humanoid, all contacts", worlds: 1,     ours: "euler", theirs: "euler", goal: None },
];

/// What to measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Articulated bodies, beside MuJoCo.
    Robots,
    /// Heaps of free bodies, beside Rapier.
    Piles,
    /// Rays, swept shapes and neighbours, beside parry3d and rstar.
    Queries,
    /// Cameras, on the CPU and, where there is one, on a graphics card.
    Cameras,
    /// The page in Chromium, drawing in software.
    Page,
    /// The Python package, beside Gymnasium's own environments.
    Python,
}

impl Group {
    pub const ALL: [Self; 6] = [
        Self::Robots,
        Self::Piles,
        Self::Queries,
        Self::Cameras,
        Self::Page,
        Self::Python,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Robots => "robots",
            Self::Piles => "piles",
            Self::Queries => "queries",
            Self::Cameras => "cameras",
            Self::Page => "page",
            Self::Python => "python",
        }
    }
    /// Where its tables begin in the report.
    fn marker(self) -> String {
        let name = self.name();
        format!("<!-- written by `cargo xtask bench {name}` from here -->")
    }
}

/// Measures, prints the tables, and writes them into the report.
pub fn run(workshop: &Workshop, groups: &[Group], repetitions: usize) -> Result<()> {
    ensure!(repetitions > 0, "at least one repetition is needed");
    for &group in groups {
        let tables = match group {
            Group::Robots => robots(workshop, repetitions)?,
            Group::Piles => format!("{}\n{}", machine(workshop)?, piles(workshop)?),
            Group::Queries => format!("{}\n{}\n", machine(workshop)?, queries(workshop)?),
            Group::Cameras => format!("{}\n{}\n", machine(workshop)?, cameras(workshop)?),
            Group::Page => format!("{}\n{}\n", machine(workshop)?, page(workshop)?),
            Group::Python => format!("{}\n{}\n", machine(workshop)?, python(workshop)?),
        };
        println!("\n{tables}");
        let report = workshop.sh.read_file(REPORT)?;
        workshop
            .sh
            .write_file(REPORT, rewritten(&report, &group.marker(), &tables)?)?;
    }
    Ok(())
}

/// The tables of articulated bodies.
fn robots(workshop: &Workshop, repetitions: usize) -> Result<String> {
    let sh = &workshop.sh;
    let python = workshop.peers_python()?;
    let folder = workshop.root.join("target/bench");
    cmd!(
        sh,
        "{python} benches/peers/mujoco_bench.py prepare {folder}"
    )
    .run()?;

    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for repetition in 1..=repetitions {
        println!("repetition {repetition} of {repetitions}");
        ours.extend(records(
            &cmd!(
                sh,
                "cargo bench --quiet --package kinetarium --bench articulated -- {folder}"
            )
            .read()?,
        )?);
        theirs.extend(records(
            &cmd!(
                sh,
                "{python} benches/peers/mujoco_bench.py measure {folder}"
            )
            .read()?,
        )?);
    }
    let mujoco = cmd!(sh, "{python} -c 'import mujoco; print(mujoco.__version__)'")
        .quiet()
        .read()?;
    Ok(format!(
        "{} MuJoCo {mujoco}. Repetitions: {repetitions}.\n\n{}\n{}\n{}",
        machine(workshop)?.trim_end(),
        speeds(&ours, &theirs)?,
        threads(&ours)?,
        sizes(&ours, &theirs)?,
    ))
}

fn records(lines: &str) -> Result<Vec<Record>> {
    lines
        .lines()
        .map(|line| {
            serde_json::from_str(line).with_context(|| format!("not a benchmark record: {line}"))
        })
        .collect()
}

/// The machine and the versions that the numbers belong to.
fn machine(workshop: &Workshop) -> Result<String> {
    let sh = &workshop.sh;
    let rustc = cmd!(sh, "rustc --version").quiet().read()?;
    let cpuinfo = sh.read_file("/proc/cpuinfo").unwrap_or_default();
    let value = |key: &str| {
        let fields = cpuinfo.lines().filter_map(|line| line.split_once(": "));
        let mut named = fields.filter(|(name, _)| name.trim_end() == key);
        named.next().map_or("", |(_, value)| value)
    };
    let lanes =
        ["avx512f", "avx2", "fma"].map(|flag| value("flags").contains(flag).then_some(flag));
    let lanes: Vec<&str> = lanes.into_iter().flatten().collect();
    let cores = std::thread::available_parallelism()?;
    Ok(format!(
        "Machine: {} (family {}, model {}; {cores} cores; {}). {rustc}.\n",
        value("model name"),
        value("cpu family"),
        value("model"),
        lanes.join(", ")
    ))
}

fn speeds(ours: &[Record], theirs: &[Record]) -> Result<String> {
    let mut table = String::from(
        "| case | worlds | Kinetarium | steps/s | error | MuJoCo | steps/s | error | ratio | goal |\n\
         |---|--:|---|--:|--:|---|--:|--:|--:|--:|\n",
    );
    for Comparison {
        case,
        worlds,
        ours: our_method,
        theirs: their_method,
        goal,
    } in COMPARISONS
    {
        let threads = if worlds == BATCH { THREADS } else { 1 };
        let (our_speed, our_error) = speed(ours, case, our_method, [worlds, threads])?;
        let (their_speed, their_error) = speed(theirs, case, their_method, [worlds, threads])?;
        let ratio = our_speed / their_speed;
        let goal = goal.map_or(String::new(), |goal| {
            format!("{goal}{}", if ratio < goal { " (missed)" } else { "" })
        });
        writeln!(
            table,
            "| {case} | {worlds} | {our_method} | {} | {} | {their_method} | {} | {} | {ratio:.1} | {goal} |",
            rate(our_speed),
            scientific(our_error),
            rate(their_speed),
            scientific(their_error),
        )?;
    }
    Ok(table)
}

/// What a second thread is worth to many worlds.
fn threads(ours: &[Record]) -> Result<String> {
    let mut table = format!(
        "| {BATCH} worlds | one thread | {THREADS} threads | ratio | goal |\n|---|--:|--:|--:|--:|\n"
    );
    let mut cases: Vec<_> = COMPARISONS
        .iter()
        .map(|comparison| comparison.case)
        .collect();
    cases.dedup();
    for case in cases {
        let (one, _) = speed(ours, case, "euler", [BATCH, 1])?;
        let (all, _) = speed(ours, case, "euler", [BATCH, THREADS])?;
        let ratio = all / one;
        let missed = if ratio < SHARED { " (missed)" } else { "" };
        let (one, all) = (rate(one), rate(all));
        writeln!(
            table,
            "| {case} | {one} | {all} | {ratio:.2} | {SHARED}{missed} |"
        )?;
    }
    Ok(table)
}

fn sizes(ours: &[Record], theirs: &[Record]) -> Result<String> {
    let load = |records| {
        median(records, |record| match record {
            Record::Load { case, seconds } if case == "humanoid" => Some(1e3 * seconds),
            _ => None,
        })
    };
    let memory = |records| {
        median(records, |record| match record {
            Record::Memory { case, bytes } if case == "humanoid" => Some(1e-3 * bytes),
            _ => None,
        })
    };
    let mut table = String::from("| humanoid | Kinetarium | MuJoCo | goal |\n|---|--:|--:|--:|\n");
    writeln!(
        table,
        "| file to first step, ms | {:.1} | {:.1} | 50 |",
        load(ours)?,
        load(theirs)?
    )?;
    writeln!(
        table,
        "| state of a world, kB | {:.1} | {:.1} | 20 |",
        memory(ours)?,
        memory(theirs)?
    )?;
    Ok(table)
}

/// The table of piles, with what it was measured with.
///
/// Rapier chooses its instructions when it is compiled, Kinetarium when it runs: so that both have
/// what the machine has, the program is compiled for this machine, and with Rapier's widest lanes.
fn piles(workshop: &Workshop) -> Result<String> {
    let table = cmd!(
        workshop.sh,
        "cargo run --quiet --profile peers --package kinetarium-bench-rapier --features simd8"
    )
    .env("RUSTFLAGS", PEER_FLAGS)
    .read()?;
    Ok(format!("{table}\n"))
}

/// The tables of shapes in simulations, and of boxes in every structure; peers are compiled as well as what they are
/// measured against.
fn queries(workshop: &Workshop) -> Result<String> {
    let sh = &workshop.sh;
    let shapes = cmd!(
        sh,
        "cargo bench --quiet --package kinetarium --bench queries"
    )
    .read()?;
    let boxes = cmd!(sh, "cargo bench --quiet --package kinetarium-space").read()?;
    Ok(format!("{shapes}\n\n{boxes}"))
}

/// The table of cameras; compiled as the program is.
fn cameras(workshop: &Workshop) -> Result<String> {
    crate::page::need_vulkan(workshop)?;
    let bench = cmd!(
        workshop.sh,
        "cargo bench --quiet --profile release --package kinetarium-render --bench frames --features gpu"
    );
    // The one card that every machine has, unless another is named.
    let card = std::env::var("KINETARIUM_GPU").unwrap_or("llvmpipe".into());
    Ok(bench.env("KINETARIUM_GPU", card).read()?)
}

/// The table of a graphics card. Cargo tells where the program is.
pub fn gpu(workshop: &Workshop, options: &[&str]) -> Result<()> {
    let sh = &workshop.sh;
    let bench = [
        "--profile",
        "release",
        "--package",
        "kinetarium",
        "--features",
        "cuda,gpu",
        "--bench",
        "cards",
    ];
    cmd!(sh, "cargo bench {bench...} --no-run").run()?;
    Ok(cmd!(sh, "cargo bench --quiet {bench...} -- {options...}").run()?)
}

/// The page's lines, as a list.
fn page(workshop: &Workshop) -> Result<String> {
    let sh = &workshop.sh;
    let _inside = sh.push_dir("web");
    crate::page::install(workshop)?;
    let lines = cmd!(sh, "npm run --silent bench").read()?;
    let lines = lines.lines().filter(|line| line.contains(':'));
    Ok(lines.map(|line| format!("- {line}\n")).collect())
}

/// How fast Python gets going, and the environments.
fn python(workshop: &Workshop) -> Result<String> {
    let sh = &workshop.sh;
    let python = workshop.python_with_package()?;
    let start = cmd!(sh, "{python} benches/peers/python_start.py").read()?;
    let steps = cmd!(sh, "{python} benches/peers/python_bench.py").read()?;
    Ok(format!("{start}\n\n{steps}\n"))
}

/// Median world-steps per second, and the error where the case has one.
fn speed(
    records: &[Record],
    case: &str,
    method: &str,
    [worlds, threads]: [u32; 2],
) -> Result<(f64, Option<f64>)> {
    let wanted = |record: &Record| match record {
        Record::Speed {
            case: c,
            method: m,
            worlds: w,
            threads: t,
            steps_per_second,
            error,
        } => {
            let is = c == case && m == method && [*w, *t] == [worlds, threads];
            is.then_some((*steps_per_second, *error))
        }
        _ => None,
    };
    let speed = median(records, |record| wanted(record).map(|(speed, _)| speed))
        .with_context(|| format!("case {case}, method {method}, {worlds} worlds"))?;
    let error = records.iter().find_map(wanted).and_then(|(_, error)| error);
    Ok((speed, error))
}

fn median(records: &[Record], value: impl Fn(&Record) -> Option<f64>) -> Result<f64> {
    let mut values: Vec<f64> = records.iter().filter_map(value).collect();
    ensure!(!values.is_empty(), "nothing was measured");
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    Ok(if values.len() % 2 == 1 {
        values[middle]
    } else {
        (values[middle - 1] + values[middle]) / 2.0
    })
}

fn rate(per_second: f64) -> String {
    if per_second >= 1e6 {
        format!("{:.2} M", 1e-6 * per_second)
    } else {
        format!("{:.0} k", 1e-3 * per_second)
    }
}

fn scientific(error: Option<f64>) -> String {
    error.map_or(String::new(), |error| format!("{error:.2e}"))
}

/// The report with other tables between a marker and the next end.
fn rewritten(report: &str, marker: &str, tables: &str) -> Result<String> {
    let parts = report
        .split_once(marker)
        .and_then(|(before, rest)| Some((before, rest.split_once(TABLES_END)?.1)));
    let Some((before, after)) = parts else {
        bail!("{REPORT} has lost its markers `{marker}` and `{TABLES_END}`");
    };
    Ok(format!("{before}{marker}\n{tables}{TABLES_END}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINES: &str = r#"{"kind": "speed", "case": "chain_10", "method": "euler", "worlds": 1, "threads": 1, "steps_per_second": 3.0, "error": 0.5}
{"kind": "speed", "case": "chain_10", "method": "euler", "worlds": 1, "threads": 1, "steps_per_second": 1.0, "error": 0.5}
{"kind": "speed", "case": "chain_10", "method": "euler", "worlds": 1, "threads": 1, "steps_per_second": 7.0, "error": 0.5}
{"kind": "speed", "case": "chain_10", "method": "rk4", "worlds": 1, "threads": 1, "steps_per_second": 100.0, "error": null}
{"kind": "load", "case": "humanoid", "seconds": 0.01}"#;

    #[test]
    fn the_median_is_taken_over_the_case_asked_for() {
        let records = records(LINES).unwrap();
        assert_eq!(
            speed(&records, "chain_10", "euler", [1, 1]).unwrap(),
            (3.0, Some(0.5))
        );
        assert_eq!(
            speed(&records, "chain_10", "rk4", [1, 1]).unwrap(),
            (100.0, None)
        );
        assert!(speed(&records, "chain_30", "euler", [1, 1]).is_err());
    }

    #[test]
    fn each_group_has_its_own_place_in_the_report() {
        let [robots, piles, ..] = Group::ALL.map(Group::marker);
        let report =
            format!("a\n{robots}\nold\n<!-- to here -->\nb\n{piles}\nold\n<!-- to here -->\nc");
        let report = rewritten(&report, &piles, "new\n").unwrap();
        let wanted =
            format!("a\n{robots}\nold\n<!-- to here -->\nb\n{piles}\nnew\n<!-- to here -->\nc");
        assert_eq!(report, wanted);
        assert!(rewritten("nothing", &piles, "new").is_err());
    }
}
