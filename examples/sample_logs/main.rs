//! Writes the sample logs and their README: `cargo run --release --example sample_logs -- sample-logs`.

mod sample;

use std::{error::Error, fs, path::PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args_os().nth(1).ok_or("name a folder to write to")?);
    fs::create_dir_all(&folder)?;
    for (name, bytes) in sample::files(sample::SMALL)? {
        fs::write(folder.join(&name), &bytes)?;
        println!("{name}: {} bytes", bytes.len());
    }
    Ok(())
}
