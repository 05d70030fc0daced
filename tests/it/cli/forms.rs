//! Tables as other programs lay them out: printed ones, headers of several rows, oscilloscopes of controllers, measurements of
//! a laboratory. The same numbers give the same report.

use std::{fmt::Write as _, fs, path::Path};

use crate::support::{run_line as hydrotrace, said};

/// Planned and measured angle, deg, of a joint that starts at 1 s and follows 0.1 s later.
fn moves(t_s: f64) -> [f64; 2] {
    let at =
        |t_s: f64| 12.0 + 10.0 * (1.0 - ((t_s - 1.0).clamp(0.0, 2.0) / 2.0 * std::f64::consts::PI).cos());
    [at(t_s), at(t_s - 0.1)]
}

/// Rows at 50 Hz of a time, a planned and a measured angle.
pub(super) fn rows(row: impl Fn(f64, f64, f64) -> String) -> String {
    let times = (0..250).map(|k| f64::from(k) * 0.02);
    times.map(|t_s| row(t_s, moves(t_s)[0], moves(t_s)[1])).collect()
}

fn comma(text: &str) -> String {
    text.replace('.', ",")
}

/// Reports a file; exit code, the lines of the run, and what is wrong.
pub(super) fn report(file: &str, text: &str) -> (i32, String, String) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(file), text).unwrap();
    said(&hydrotrace(folder.path(), &format!("report {file}")))
}

/// Each file is read as a plain table with the same numbers is.
fn all_alike(files: &[(&str, String)]) {
    let plain =
        "t_s,boom_set_deg,boom_act_deg\n".to_owned() + &rows(|t, p, m| format!("{t:.2},{p:.4},{m:.4}\n"));
    let (code, text, error) = report("plain.csv", &plain);
    assert_eq!(code, 0, "{text}{error}");
    let worst = |text: &str| text.lines().find(|line| line.starts_with("Worst start")).map(str::to_owned);
    let expected = worst(&text).unwrap();
    assert!(expected.contains(" boom at 1."), "{expected}");
    for (file, text) in files {
        let (code, said, error) = report(file, text);
        let start: String = text.chars().take(300).collect();
        assert!(code == 0 || code == 3, "{file} {code} {error}\n{start}");
        assert_eq!(worst(&said).as_ref(), Some(&expected), "{file}\n{start}\n{said}");
        assert_eq!(code, i32::from(said.contains("guessed x")) * 3, "{file}\n{said}");
    }
}

#[test]
fn printed_tables_and_quoted_decimal_commas_are_tables() {
    let bars = |t: f64, p: f64, m: f64| format!("| {t:.2} | {p:.4} | {m:.4} |\n");
    let open = |t: f64, p: f64, m: f64| format!(" {t:6.2} | {p:10.4} | {m:10.4}\n");
    let quoted =
        |t: f64, p: f64, m: f64| comma(&format!("\"{t:.2}\";\"{p:.4}\";\"{m:.4}\"\n")).replace(';', ",");
    let rule = "+------+--------------+--------------+\n";
    let names = "| t_s | boom_set_deg | boom_act_deg |\n";
    all_alike(&[
        (
            "psql.txt",
            " t_s | boom_set_deg | boom_act_deg \n-----+--------------+-----\n".to_owned()
                + &rows(open)
                + "(250 rows)\n\n",
        ),
        ("mysql.txt", format!("{rule}{names}{rule}{}{rule}250 rows in set (0.00 sec)\n", rows(bars))),
        ("run.md", format!("# Run 7\n\nOf May.\n\n{names}|----:|:---:|---|\n{}\nThe end.\n", rows(bars))),
        ("quoted.csv", "t_s,boom_set_deg,boom_act_deg\n".to_owned() + &rows(quoted)),
        (
            "preamble.csv",
            "Logger;7\nRate;50;Hz;of;all;channels\nOffsets;0,0\n\nt_s;boom_set_deg;boom_act_deg\n".to_owned()
                + &rows(|t, p, m| comma(&format!("{t:.2};{p:.4};{m:.4}\n"))),
        ),
    ]);
}

#[test]
fn headers_of_several_rows_are_names_in_full() {
    let two = rows(|t, p, m| format!("{t:.2},{p:.4},{m:.4},{:.4},{:.4}\n", 0.5 * p, 0.5 * m));
    let one = rows(|t, p, m| format!("{t:.2},{p:.4},{m:.4}\n"));
    all_alike(&[
        ("frame.csv", format!(",boom,boom,arm,arm\n,set_deg,act_deg,set_deg,act_deg\n{two}")),
        ("index.csv", format!(",boom,boom,arm,arm\n,set_deg,act_deg,set_deg,act_deg\nt_s,,,,\n{two}")),
        ("named.csv", format!("joint,boom,boom\nsignal,set_deg,act_deg\nt_s,,\n{one}")),
        ("turned.csv", format!("signal,set_deg,act_deg\njoint,boom,boom\nt_s,,\n{one}")),
        ("merged.csv", format!("t_s,boom,,arm,\n,set_deg,act_deg,set_deg,act_deg\n{two}")),
    ]);
}

#[test]
fn recordings_of_an_oscilloscope_have_a_clock_for_each_signal() {
    let head = |separator: &str| {
        let text = "Name;Project\nFile;a.csv\nStarttime of export;134171640000000000;Monday\n\n\
             Name;MAIN.boom.SetPos;Name;MAIN.boom.ActPos\nSymbolComment;;SymbolComment;\n\
             Data-Type;REAL64;Data-Type;REAL64\nSampleTime[ms];20;SampleTime[ms];20\nPort;851;Port;851\n\
             Offset;0;Offset;0\nScaleFactor;1;ScaleFactor;1\nUnit;deg;Unit;deg\n\n";
        text.replace(';', separator)
    };
    let late = |t: f64, p: f64, m: f64| comma(&format!("{:.0}\t{p:.4}\t{:.0}\t{m:.4}\n", 1e3 * t, 1e3 * t));
    let text = format!("{}{}EOF\n", head("\t"), rows(late));
    let (code, found, error) = report("scope.csv", &text);
    assert_eq!(code, 0, "{found}{error}");
    assert!(
        found.contains("MAIN.boom.SetPos [deg]") && found.contains("Time (yyyy-mm-dd hh:mm:ss with zone"),
        "{found}"
    );
    let scaled = text.replace("ScaleFactor\t1\tScaleFactor\t1", "ScaleFactor\t1\tScaleFactor\t2");
    let (code, found, error) = report("scope.csv", &scaled);
    assert!(code == 3 && found.contains("ScaleFactor"), "{found}{error}");
}

#[test]
fn measurements_of_a_laboratory_have_one_clock_many_or_none() {
    let head = |columns: &str| {
        format!(
            "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n\
             Multi_Headings\tNo\nX_Columns\t{columns}\nTime_Pref\tAbsolute\n***End_of_Header***\t\n\t\n\
             Channels\t2\t\t\t\nSamples\t250\t250\t\t\nDate\t2026/03/05\t2026/03/05\nTime\t12:00:00.5\t12:00:00.5\n\
             Y_Unit_Label\tdeg\tdeg\nX_Dimension\tTime\tTime\nX0\t0.0E+0\t0.0E+0\nDelta_X\t0.020\t0.020\n\
             ***End_of_Header***\t\t\t\n"
        )
    };
    all_alike(&[
        (
            "multi.lvm",
            head("Multi")
                + "X_Value\tboom set\tX_Value\tboom act\tComment\n"
                + &rows(|t, p, m| format!("{t:.6}\t{p:.4}\t{t:.6}\t{m:.4}\n")),
        ),
        (
            "one.lvm",
            head("One")
                + "X_Value\tboom set\tboom act\tComment\n"
                + &rows(|t, p, m| format!("{t:.6}\t{p:.4}\t{m:.4}\n")),
        ),
        (
            "none.lvm",
            head("No")
                + "X_Value\tboom set\tboom act\tComment\n"
                + &rows(|_, p, m| format!("\t{p:.4}\t{m:.4}\n")),
        ),
    ]);
}

#[test]
fn the_only_column_in_a_unit_of_time_is_the_time_and_units_have_prefixes() {
    let row = |t: f64, p: f64, m: f64| format!("{:.0},{:.0},{:.0}\n", 1e3 * t, 1e3 * p, 1e3 * m);
    for (header, code, column) in [
        ("tick_ms,boom_set_mdeg,boom_act_mdeg", 3, "tick_ms"),
        ("t_ms,boom_set_millideg,boom_act_millideg", 0, "t_ms"),
    ] {
        let (found, text, error) = report("a.csv", &(format!("{header}\n") + &rows(row)));
        assert_eq!(found, code, "{header} {text}{error}");
        assert!(text.contains(&format!("{column} (counts ms)")) && text.contains("boom at 1.0"), "{text}");
        assert_eq!(text.contains("is the only one in a unit of time"), code == 3, "{text}");
    }
    let two = |t: f64, p: f64, _: f64| format!("{:.0},{:.0},{p:.3}\n", 1e3 * t, 1e3 * t + 1.0);
    let (code, _, error) = report("a.csv", &(format!("tick_ms,up_ms,boom_set_deg\n{}", rows(two))));
    assert!(code == 1 && error.contains("no column looks like a time"), "{code} {error}");
}

#[test]
fn how_long_a_cycle_took_is_no_clock() {
    // Goes up and down, and stands.
    for took in [|t: f64| 400.0 + 30.0 * (1e3 * t).sin(), |_| 400.0] {
        let row = |t: f64, p: f64, m: f64| format!("{:.0},{:.0},{p:.4},{m:.4}\n", 1e3 * t, took(t));
        for names in ["tick_ms,exec_time_us", "uptime_ms,cycle time [us]", "time_ms,loop_time_us"] {
            let text = format!("{names},boom_set_deg,boom_act_deg\n{}", rows(row));
            let (code, text, error) = report("a.csv", &text);
            let clock = format!("{} (counts ms)", names.split(',').next().unwrap());
            assert!(code != 1 && text.contains(&clock) && text.contains(" boom at 1."), "{text}{error}");
        }
    }
}

#[test]
fn readings_that_were_lost_are_left_out_and_told() {
    let text = |lost: &dyn Fn(f64) -> bool| {
        let row = |t: f64, p: f64, m: f64| format!("{t:.2},{p:.4},{:.4}\n", if lost(t) { 0.0 } else { m });
        "t_s,boom_set_deg,boom_act_deg\n".to_owned() + &rows(row)
    };
    let at = |t: f64, at: f64| (t - at).abs() < 0.001;
    let (code, found, error) = report("a.csv", &text(&|t| at(t, 0.5) || at(t, 0.8)));
    let told = "implausible x2  values of /joint_states that are exactly 0 once";
    assert!(code == 3 && found.contains(told) && found.contains("248 samples"), "{found}{error}");
    // Two in turn are no single reading.
    let (_, found, _) = report("a.csv", &text(&|t| at(t, 0.5) || at(t, 0.52)));
    assert!(!found.contains("exactly 0 once"), "{found}");
}

/// Messages of a bridge, which are objects around a message.
#[test]
fn messages_of_a_bridge_are_read_without_what_is_around_them() {
    for (seconds, parts, count) in [("sec", "nanosec", ""), ("secs", "nsecs", "\"seq\": 7, ")] {
        let mut text = String::new();
        for k in 0..250_u32 {
            let values = moves(f64::from(k) * 0.02).map(f64::to_radians);
            for (topic, angle) in ["/planned_joint_states", "/joint_states"].into_iter().zip(values) {
                writeln!(
                    text,
                    "{{\"op\": \"publish\", \"topic\": \"{topic}\", \"msg\": {{\"header\": {{{count}\"stamp\": {{\"{seconds}\": {}, \
                     \"{parts}\": {}}}, \"frame_id\": \"\"}}, \"name\": [\"boom\", \"arm\"], \"position\": [{angle}, {angle}], \
                     \"velocity\": []}}}}",
                    1_772_700_000 + k / 50,
                    k % 50 * 20_000_000
                )
                .unwrap();
            }
        }
        let (code, found, error) = report("a.jsonl", &text);
        assert_eq!(code, 3, "{found}{error}");
        let clock = format!("header_stamp_{seconds}, header_stamp_{parts} (counts s, and ns beside)");
        assert!(
            found.contains(&clock) && found.contains("2 joints") && !found.contains("clock-jump"),
            "{found}"
        );
    }
}

#[test]
fn the_line_that_imports_a_table_repeats_what_was_given() {
    let folder = tempfile::tempdir().unwrap();
    let folder: &Path = folder.path();
    let text = "t_s,p1,m1\n".to_owned() + &rows(|t, p, m| format!("{t:.2},{p:.4},{m:.4}\n"));
    fs::write(folder.join("a.csv"), text).unwrap();
    let line = |options: &str| {
        let (code, _, error) = said(&hydrotrace(folder, &format!("report a.csv {options}")));
        assert_eq!(code, 1, "{error}");
        error
    };
    let error = line("--planned boom=p1 --measured boom=m1 --planned-degrees --measured-degrees");
    let paste = "import a.csv --planned boom=p1 --measured boom=m1 --degrees -o a.mcap";
    assert!(error.contains(&format!("`hydrotrace {paste}`")), "{error}");
    let (code, _, error) = said(&hydrotrace(folder, paste));
    assert_eq!(code, 0, "{error}");
    let error = line("--planned p1 --time log --joints boom");
    assert!(error.contains("--planned JOINT=p1 -o a-2.mcap` takes options for that"), "{error}");
    assert!(error.contains("with the other options of this line"), "{error}");
    // Columns of a log that was made of a table are for its import, too.
    let (code, _, error) = said(&hydrotrace(folder, "report a.mcap --planned boom=m1 --measured boom=p1"));
    let again = "hydrotrace import a.csv --degrees --planned boom=m1 --measured boom=p1 -o a-2.mcap";
    assert!(code == 1 && error.contains(again), "{error}");
    let (code, _, error) = said(&hydrotrace(folder, "report a.mcap --measured p1"));
    assert!(code == 1 && error.contains("--measured JOINT=p1") && !error.contains("no topic"), "{error}");
}

#[test]
fn a_stamp_in_the_first_columns_of_a_table_without_names_is_its_time() {
    let folder = tempfile::tempdir().unwrap();
    let row = |t: f64, p: f64, m: f64| {
        let ns = (t * 1e9).round();
        let (s, beyond) = (1_772_700_000.0 + (ns / 1e9).floor(), ns % 1e9);
        format!("{s},{beyond},,boom,{:.6},{:.6}\n", p.to_radians(), m.to_radians())
    };
    fs::write(folder.path().join("a.csv"), rows(row)).unwrap();
    let line = "import a.csv --planned boom=column_5 --measured boom=column_6 --radians -o a.mcap";
    let (code, found, error) = said(&hydrotrace(folder.path(), line));
    assert!(code == 3 && found.contains("one joint, 4.98 s at 50.0 Hz"), "{found}{error}");
    assert!(found.contains("column_1 and column_2: counts s, and ns beside"), "{found}");
    assert!(found.contains("which is how `ros2 topic echo --csv` writes stamps"), "{found}");
}

#[test]
fn whole_seconds_of_many_rows_each_are_spread_and_uneven_ones_refused_with_the_rate_as_the_way_out() {
    let row = |t: f64, p: f64, m: f64| format!("10:59:{:02.0},{p:.4},{m:.4}\n", t.floor());
    let text = format!("time,boom_set_deg,boom_act_deg\n{}", rows(row));
    let (code, out, error) = report("a.csv", &text);
    assert!(code == 3 && out.contains("repeats each stamp in"), "{code} {out}{error}");
    let uneven = |t: f64, p: f64, m: f64| format!("10:59:{:02.0},{p:.4},{m:.4}\n", (0.2 * t * t).floor());
    let (code, _, error) = report("a.csv", &format!("time,boom_set_deg,boom_act_deg\n{}", rows(uneven)));
    let says = |part: &str| error.contains(part);
    assert!(code == 1 && says("import a.csv --rate HZ") && says("or --time COLUMN"), "{code} {error}");
}

#[test]
fn a_parquet_table_of_another_program_is_imported_as_the_same_rows_in_text() {
    let folder = tempfile::tempdir().unwrap();
    let log = crate::support::sample("panel-install.mcap").display().to_string();
    for form in ["csv", "parquet"] {
        assert_ne!(said(&hydrotrace(folder.path(), &format!("export {log} -o a.{form}"))).0, 1);
    }
    let mut other = fs::read(folder.path().join("a.parquet")).unwrap();
    for at in other.len() - 2000..other.len() - 10 {
        if &other[at..at + 10] == b"hydrotrace" {
            other[at..at + 10].copy_from_slice(b"other prog");
        }
    }
    fs::write(folder.path().join("a.parquet"), other).unwrap();
    for options in [
        "--slides joint_1=mm",
        "--planned j=joint_1_measured_rad --measured j=joint_1_planned_rad",
        "--rate 10",
    ] {
        let read = |form: &str| {
            let import = format!("import a.{form} -o {form}.mcap --force {options}");
            let (code, text, error) = said(&hydrotrace(folder.path(), &import));
            assert_ne!(code, 1, "{import} {error}");
            let (_, report, _) = said(&hydrotrace(folder.path(), &format!("report {form}.mcap")));
            [text, report].map(|text| text.replace(form, "csv"))
        };
        assert_eq!(read("parquet"), read("csv"), "{options}");
    }
}

/// A column of whole numbers and two of half floats, as pandas, polars and pyarrow write a `timedelta` and `float16`.
fn halves(name: &str, schema: &str, count_per_s: f64) -> Vec<u8> {
    use parquet::{
        data_type::{ByteArray, FixedLenByteArray, FixedLenByteArrayType, Int64Type},
        file::{metadata::KeyValue, properties::WriterProperties, writer::SerializedFileWriter},
        schema::parser::parse_message_type,
    };
    let half = |value: f64| {
        let bits = (value as f32).to_bits();
        let [sign, exponent, fraction] = [bits >> 31, bits >> 23 & 0xFF, bits >> 13 & 0x3FF];
        let half = sign << 15 | exponent.saturating_sub(112) << 10 | fraction;
        FixedLenByteArray::from(ByteArray::from((half as u16).to_le_bytes().to_vec()))
    };
    let text = format!(
        "message run {{ required int64 {name}; required fixed_len_byte_array(2) boom_set_deg (FLOAT16); required \
         fixed_len_byte_array(2) boom_act_deg (FLOAT16); }}"
    );
    let beside = KeyValue::new("ARROW:schema".to_owned(), schema.to_owned());
    let properties = WriterProperties::builder().set_key_value_metadata(Some(vec![beside])).build();
    let message = parse_message_type(&text).unwrap().into();
    let mut writer = SerializedFileWriter::new(Vec::new(), message, properties.into()).unwrap();
    let mut group = writer.next_row_group().unwrap();
    let times: Vec<f64> = (0..250).map(|k| f64::from(k) * 0.02).collect();
    let mut column = group.next_column().unwrap().unwrap();
    let counts: Vec<i64> = times.iter().map(|t_s| (t_s * count_per_s).round() as i64).collect();
    column.typed::<Int64Type>().write_batch(&counts, None, None).unwrap();
    column.close().unwrap();
    for side in 0..2 {
        let mut column = group.next_column().unwrap().unwrap();
        let values: Vec<FixedLenByteArray> = times.iter().map(|t_s| half(moves(*t_s)[side])).collect();
        column.typed::<FixedLenByteArrayType>().write_batch(&values, None, None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.into_inner().unwrap()
}

#[test]
fn durations_and_half_floats_of_a_parquet_table_are_times_and_numbers() {
    // Of columns `time: duration[us]` and `__index_level_0__: duration[ns]`, beside two of half floats.
    let us = "/////+AAAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAMAAACAAAAAOAAAAAQAAACc////AAABAxAAAAAgAAAAB\
              AAAAAAAAAAMAAAAYm9vbV9hY3RfZGVnAAAAAND////M////AAABAxAAAAAkAAAABAAAAAAAAAAMAAAAYm9vbV9zZXRfZGVnAAAAAAQABAAEAAAAEAA\
              UAAgABgAHAAwAAAAQABAAAAAAAAESEAAAABwAAAAEAAAAAAAAAAQAAAB0aW1lAAAGAAgABgAGAAAAAAACAA==";
    let ns = "//////AAAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAMAAACIAAAARAAAAAQAAACU////AAABEhAAAAAoAA\
              AABAAAAAAAAAARAAAAX19pbmRleF9sZXZlbF8wX18ABgAIAAYABgAAAAAAAwDQ////AAABAxAAAAAgAAAABAAAAAAAAAAMAAAAYm9vbV9hY3Rf\
              ZGVnAAAAAMD///8QABQACAAGAAcADAAAABAAEAAAAAAAAQMQAAAAJAAAAAQAAAAAAAAADAAAAGJvb21fc2V0X2RlZwAAAAAEAAQABAAAAAAAAA\
              A=";
    for (name, schema, per_s) in [("time", us, 1e6), ("__index_level_0__", ns, 1e9)] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.parquet"), halves(name, schema, per_s)).unwrap();
        let (code, text, error) = said(&hydrotrace(folder.path(), "import a.parquet -o a.mcap"));
        assert!(code != 1 && text.contains("one joint, 4.98 s at 50.0 Hz"), "{name}: {text}{error}");
        assert!(text.contains("time passed"), "{name}: {text}");
        let peak =
            crate::support::json(folder.path(), "report a.mcap")["joints"][0]["tracking_error"]["peak"]
                .as_f64()
                .unwrap();
        // 0.1 s late at up to 15.7 deg/s; half floats near 32 have steps of 0.016.
        assert!((peak.to_degrees() - 1.56).abs() < 0.05, "{name}: {peak}");
    }
}

#[test]
fn two_clocks_are_judged_by_all_rows() {
    let row =
        |t: f64, p: f64, m: f64| format!("{t:.2},{:.2},{p:.4},{m:.4}\n", if t < 4.5 { t } else { t - 0.3 });
    let text = "t_a_s,stamp,boom_set_deg,boom_act_deg\n".to_owned() + &rows(row);
    let (code, text, error) = report("a.csv", &text);
    assert!(code == 3 && text.contains("0.300 s away"), "{text}{error}");
}
