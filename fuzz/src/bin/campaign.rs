//! Mutations in one process: `campaign [COUNT] [SEED] [TARGET]`; `campaign seeds` writes what it begins with into
//! `fuzz/corpus` for the fuzzer. Says how many were read, how fast, and the slowest; an
//! input that panics, or takes more than ten seconds, is written to `fuzz/artifacts` and ends the campaign with 1.

use std::{
    collections::BTreeMap,
    fs,
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
    process::ExitCode,
    time::{Duration, Instant},
};

use hydrotrace_fuzz::{
    TARGETS, Target,
    mutate::{Dice, mutate},
    seeds,
};

const LONGEST: Duration = Duration::from_secs(10);

/// A target, its seeds, and what was done with it.
struct Corpus {
    target: Target,
    seeds: Vec<Vec<u8>>,
    inputs: u64,
    spent: Duration,
    slowest: Duration,
}

fn keep(name: &str, bytes: &[u8], why: &str) -> ExitCode {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("artifacts").join(name);
    let file = folder.join(format!("campaign-{:08x}", crc(bytes)));
    let kept = fs::create_dir_all(&folder).and_then(|()| fs::write(&file, bytes));
    eprintln!("{name}: an input {why}: {} {kept:?}", file.display());
    ExitCode::FAILURE
}

fn crc(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0x811C_9DC5, |hash: u32, byte| (hash ^ u32::from(*byte)).wrapping_mul(0x0100_0193))
}

/// Writes the seeds of all targets.
fn write_seeds() -> std::io::Result<()> {
    for (name, ..) in TARGETS {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(name);
        fs::create_dir_all(&folder)?;
        for (k, seed) in seeds::of(name).iter().enumerate() {
            fs::write(folder.join(format!("seed-{k}")), seed)?;
        }
    }
    Ok(())
}

fn main() -> ExitCode {
    if std::env::args().nth(1).is_some_and(|first| first == "seeds") {
        return write_seeds().map_or(ExitCode::FAILURE, |()| ExitCode::SUCCESS);
    }
    // On a thread of the pool: handing each input over to it would take longer than reading it.
    match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(pool) => pool.install(run),
        Err(_) => ExitCode::FAILURE,
    }
}

fn run() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let mut number = |usual: u64| arguments.next().and_then(|text| text.parse().ok()).unwrap_or(usual);
    let (count, seed) = (number(1_000_000), number(1));
    let only = std::env::args().nth(3);
    let chosen = TARGETS.into_iter().filter(|(name, ..)| only.as_ref().is_none_or(|only| only == name));
    let mut all: Vec<Corpus> = chosen
        .map(|target| {
            let (inputs, spent, slowest) = (0, Duration::ZERO, Duration::ZERO);
            Corpus { target, seeds: seeds::of(target.0), inputs, spent, slowest }
        })
        .collect();
    if let Some(empty) = all.iter().find(|corpus| corpus.seeds.is_empty()) {
        eprintln!("{}: no seeds", empty.target.0);
        return ExitCode::FAILURE;
    }
    let shares: usize = all.iter().map(|corpus| corpus.target.2).sum();
    let start = Instant::now();
    for index in 0..count {
        let mut dice = Dice(seed ^ index.wrapping_mul(0xD134_2543_DE82_EF95));
        let mut share = dice.below(shares);
        let place = all.iter().position(|corpus| {
            let here = share < corpus.target.2;
            share = share.saturating_sub(corpus.target.2);
            here
        });
        let Some(corpus) = place.and_then(|place| all.get_mut(place)) else { continue };
        let mut bytes = corpus.seeds[dice.below(corpus.seeds.len())].clone();
        let other = &corpus.seeds[dice.below(corpus.seeds.len())];
        mutate(&mut bytes, other, &mut dice);
        let (name, feed, _) = corpus.target;
        let begun = Instant::now();
        if catch_unwind(AssertUnwindSafe(|| feed(&bytes))).is_err() {
            return keep(name, &bytes, "panics");
        }
        let took = begun.elapsed();
        if took > LONGEST {
            return keep(name, &bytes, "takes more than ten seconds");
        }
        corpus.inputs += 1;
        corpus.spent += took;
        corpus.slowest = corpus.slowest.max(took);
        if (index + 1) % 1_000_000 == 0 {
            eprintln!("{} inputs in {:.0} s", index + 1, start.elapsed().as_secs_f64());
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "{count} inputs of seed {seed} in {seconds:.0} s, {:.0} a second; none panics",
        count as f64 / seconds
    );
    let by_name: BTreeMap<&str, &Corpus> = all.iter().map(|corpus| (corpus.target.0, corpus)).collect();
    for (name, Corpus { inputs, spent, slowest, .. }) in by_name {
        let each_us = spent.as_secs_f64() * 1e6 / (*inputs).max(1) as f64;
        println!(
            "{name}: {inputs} inputs, {each_us:.0} us each, {:.1} ms the slowest",
            slowest.as_secs_f64() * 1e3
        );
    }
    ExitCode::SUCCESS
}
