fn main() {
    let paths: Vec<std::path::PathBuf> = std::env::args().skip(1).map(Into::into).collect();
    let t = std::time::Instant::now();
    let r = hydrotrace::log::read_recording(&paths, &Default::default());
    let dt = t.elapsed();
    match r {
        Ok(r) => {
            println!("{:#?}", r.source);
            for t in &r.planned.tracks {
                println!("P {} {} {:?} v {}", t.name(), t.len(), t.segments(), t.velocity_rad_s().is_some());
            }
            for t in &r.measured.tracks {
                let p = r.planned.track(t.name());
                let pk = p.and_then(|p| hydrotrace::series::align(p, t)).map(|a| {
                    a.planned_rad.iter().zip(&a.measured_rad).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
                });
                println!("M {} {} {:?} peak {:?}", t.name(), t.len(), t.segments(), pk);
            }
            for m in r.remarks.as_slice() {
                println!("{m:?}");
            }
        }
        Err(e) => println!("ERR {e}"),
    }
    println!("{dt:?}");
}
