//! Messages of types that nobody told the reader of: their fields say what they are.

use std::fs;

use super::{cdr::Cdr, file::Channel, *};
use crate::support::{run_line, said, scratch};

const HEADER: &str = "\n================================================================================\nMSG: std_msgs/Header\n\
                      builtin_interfaces/Time stamp\nstring frame_id\n\
                      ================================================================================\n\
                      MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

fn header(cdr: &mut Cdr, k: i64) {
    cdr.i32((stamp(k) / 1_000_000_000) as i32);
    cdr.u32((stamp(k) % 1_000_000_000) as u32);
    cdr.text("");
}

/// A topic whose messages `write` fills behind their header; the recorder had them 3 ms later.
fn add(log: &mut Log, topic: &str, fields: &str, write: impl Fn(&mut Cdr, i64)) {
    let schema = format!("std_msgs/Header header\n{fields}{HEADER}");
    let channel = log.channel(Channel::cdr(topic, "our_arm/msg/Any").with_schema("ros2msg", schema));
    for k in 0..SAMPLES {
        let data = Cdr::message(cdr::Kind::LittleEndian, |cdr| {
            header(cdr, k);
            write(cdr, k);
        });
        log.send(channel, stamp(k) + 3_000_000, data);
    }
}

/// A log of one topic, `/arm/any`.
fn of(fields: &str, write: impl Fn(&mut Cdr, i64)) -> Log {
    let mut log = Log::default();
    add(&mut log, "/arm/any", fields, write);
    log
}

#[track_caller]
fn assert_both(log: &Log, names: [&str; 2]) {
    let recording = read(log);
    assert_eq!([joints(&recording.planned), joints(&recording.measured)], [names, names]);
    for (series, values) in
        [(&recording.planned, plan as fn(i64) -> Vec<f64>), (&recording.measured, measurement)]
    {
        for (j, track) in series.tracks.iter().enumerate() {
            let expected: Vec<f64> = (0..SAMPLES).map(|k| values(k)[j]).collect();
            let far = |(q, e): (&f64, &f64)| (q - e).abs() > 1e-12;
            assert_eq!(track.len(), expected.len(), "{names:?}");
            assert!(
                !track.position().iter().zip(&expected).any(far),
                "{}: {:?}",
                track.name(),
                track.position()
            );
            assert!((track.t_s()[10] - 0.2).abs() < 1e-9, "{:?}", track.t_s());
        }
    }
    assert!(
        recording.remarks.as_slice().iter().all(|remark| remark.code == Code::Guessed),
        "{:?}",
        recording.remarks
    );
    assert!(count(&recording.remarks, Code::Guessed) > 0);
}

#[test]
fn arrays_of_one_message_are_plan_and_measurement_by_their_names() {
    let arrays = |cdr: &mut Cdr, k: i64| {
        measurement(k).iter().chain(&plan(k)).chain(&[7.0, 7.0]).for_each(|value| cdr.f64(*value));
    };
    let log = of(
        "float64[2] measured_joint_position\nfloat64[2] desired_joint_position\nfloat64[2] torque\n",
        arrays,
    );
    assert_both(&log, ["joint_0", "joint_1"]);
    assert_both(&of("float64[2] q\nfloat64[2] q_d\nfloat64[2] tau_J\n", arrays), ["joint_0", "joint_1"]);
    let named = of("string[] names\nfloat64[] target\nfloat64[] actual\n", |cdr, k| {
        cdr.list(&["boom", "stick"], |cdr, name| cdr.text(name));
        cdr.f64s(&plan(k));
        cdr.f64s(&measurement(k));
    });
    assert_both(&named, ["boom", "stick"]);
}

#[test]
fn a_list_of_joints_and_one_joint_a_message_are_told_by_their_names() {
    let one = |cdr: &mut Cdr, k: i64, j: usize| {
        cdr.text(["boom", "stick"][j]);
        cdr.f64(plan(k)[j]);
        cdr.f64(measurement(k)[j]);
    };
    let list = "our_arm/Axis[] axes\n================================================================================\n\
                MSG: our_arm/Axis\nstring name\nfloat64 reference\nfloat64 feedback\n";
    let log = of(list, |cdr, k| cdr.list(&[0, 1], |cdr, j| one(cdr, k, *j)));
    assert_both(&log, ["boom", "stick"]);
    let named = options(&["/arm/any:axes.reference"], &["/arm/any:axes.feedback"], &[]);
    let recording = read_with(&log, &named);
    assert_eq!(joints(&recording.planned), ["boom", "stick"]);
    assert_eq!(recording.planned.tracks[0].position()[20], plan(20)[0]);

    let mut alone = Log::default();
    let channel = alone.channel(Channel::cdr("/axis", "our_arm/msg/Axis").with_schema(
        "ros2msg",
        format!("std_msgs/Header header\nstring name\nfloat64 set_point\nfloat64 process_value\n{HEADER}"),
    ));
    for (k, j) in (0..SAMPLES).flat_map(|k| [(k, 0), (k, 1)]) {
        let data = Cdr::message(cdr::Kind::LittleEndian, |cdr| {
            header(cdr, k);
            one(cdr, k, j);
        });
        alone.send(channel, stamp(k) + 1_000_000 * (j as i64 + 1), data);
    }
    assert_both(&alone, ["boom", "stick"]);
}

#[test]
fn a_topic_for_each_joint_gives_it_the_name() {
    let mut log = Log::default();
    for (j, name) in ["boom", "stick"].into_iter().enumerate() {
        add(
            &mut log,
            &format!("/{name}_controller/state"),
            "float64 set_point\nfloat64 process_value\nfloat64 p\nfloat64 i\n",
            |cdr, k| {
                [plan(k)[j], measurement(k)[j], 50.0, 0.1].into_iter().for_each(|value| cdr.f64(value));
            },
        );
    }
    log.messages.sort_by_key(|message| message.log_ns);
    assert_both(&log, ["boom", "stick"]);

    assert_both(&numbers(0, None), ["boom", "stick"]);
    // Other instants of each topic are no numbers that lack.
    assert_eq!(count(&read(&numbers(1, None)).remarks, Code::NotFinite), 0);
    let lacks = read(&numbers(1, Some(7)));
    assert_eq!(count(&lacks.remarks, Code::NotFinite), 4, "{:?}", lacks.remarks);
}

/// A topic for each number, each so much later than the one before; at one place no number.
fn numbers(later_ns: i64, none_at: Option<i64>) -> Log {
    let mut numbers = Log::default();
    let topics = ["/boom/setpoint", "/boom/angle", "/stick/setpoint", "/stick/angle"];
    for (at, topic) in topics.into_iter().enumerate() {
        let of = move |k: i64| if at % 2 == 0 { plan(k)[at / 2] } else { measurement(k)[at / 2] };
        let value = |k| if none_at == Some(k) { f64::NAN } else { of(k) };
        let channel = numbers
            .channel(Channel::cdr(topic, "std_msgs/msg/Float64").with_schema("ros2msg", "float64 data\n"));
        for k in 0..SAMPLES {
            let at_ns = stamp(k) + at as i64 * later_ns;
            numbers.send(channel, at_ns, Cdr::message(cdr::Kind::LittleEndian, |cdr| cdr.f64(value(k))));
        }
    }
    numbers
}

#[test]
fn topics_say_a_side_and_go_with_messages_that_are_known() {
    let fields = "float64 boom\nfloat64 stick\n";
    let write = |values: fn(i64) -> Vec<f64>| {
        move |cdr: &mut Cdr, k: i64| values(k).into_iter().for_each(|value| cdr.f64(value))
    };
    let mut log = Log::default();
    add(&mut log, "/arm/setpoints", fields, write(plan));
    add(&mut log, "/arm/feedback", fields, write(measurement));
    assert_both(&log, ["boom", "stick"]);

    let joints = |log: &mut Log, topic: &str, values: fn(i64) -> Vec<f64>| {
        log.add(Channel::states(topic), 0..SAMPLES, |k| states(k, &["boom", "stick"], &values(k)));
    };
    let mut measured = Log::default();
    add(&mut measured, "/arm/reference", fields, write(plan));
    joints(&mut measured, "/joint_states", measurement);
    assert_both(&measured, ["boom", "stick"]);

    let mut planned = Log::default();
    joints(&mut planned, "/planned/joint_states", plan);
    add(&mut planned, "/arm/feedback", fields, write(measurement));
    assert_both(&planned, ["boom", "stick"]);
    assert_eq!(read(&planned).source.planned_topic, "/planned/joint_states");

    // As `join` writes it: the message's own plan is none beside that.
    let mut joined = Log::default();
    joints(&mut joined, "/planned/joint_states", plan);
    let schema = "our_arm/Axis[] axes\n================================================================================\n\
                  MSG: our_arm/Axis\nstring name\nfloat64 reference\nfloat64 feedback\n";
    add(&mut joined, "/arm/any", schema, |cdr, k| {
        cdr.list(&[0, 1], |cdr, j| {
            cdr.text(["boom", "stick"][*j]);
            cdr.f64(9.0);
            cdr.f64(measurement(k)[*j]);
        });
    });
    assert_both(&joined, ["boom", "stick"]);
}

#[test]
fn motors_of_a_command_and_of_a_state_are_told_by_their_places() {
    let list = |of: &str, fields: &str| {
        format!(
            "our_arm/{of}[2] motor_{}\n================================================================================\n\
             MSG: our_arm/{of}\nuint8 mode\n{fields}",
            of.to_lowercase()
        )
    };
    let mut log = Log::default();
    add(&mut log, "/lowcmd", &list("Cmd", "float32 q\nfloat32 kp\n"), |cdr, k| {
        cdr.array(&plan(k), |cdr, q| {
            cdr.u8(1);
            cdr.f32(*q as f32);
            cdr.f32(50.0);
        });
    });
    add(&mut log, "/lowstate", &list("State", "float32 q\nfloat32 q_raw\n"), |cdr, k| {
        cdr.array(&measurement(k), |cdr, q| {
            cdr.u8(1);
            cdr.f32(*q as f32);
            cdr.f32(*q as f32 + 0.1);
        });
    });
    let recording = read(&log);
    assert_eq!([joints(&recording.planned), joints(&recording.measured)], [["joint_0", "joint_1"]; 2]);
    assert!(count(&recording.remarks, Code::PlanIsCommand) > 0, "{:?}", recording.remarks);
    assert!((recording.planned.tracks[1].position()[7] - plan(7)[1]).abs() < 1e-6);
}

#[test]
fn places_of_lists_are_not_taken_for_joints_that_are_counted_otherwise() {
    let mut log = Log::default();
    for (topic, values) in [("/arm/target", plan as fn(i64) -> Vec<f64>), ("/arm/actual", measurement)] {
        let layout = "std_msgs/MultiArrayLayout layout\nfloat64[] data\n\
                      ================================================================================\n\
                      MSG: std_msgs/MultiArrayLayout\nuint32 data_offset\n";
        let channel = Channel::cdr(topic, "std_msgs/msg/Float64MultiArray").with_schema("ros2msg", layout);
        log.add(channel, 0..SAMPLES, |k| {
            Cdr::message(cdr::Kind::LittleEndian, |cdr| {
                cdr.u32(0);
                cdr.f64s(&values(k));
            })
        });
    }
    assert_both(&log, ["joint_0", "joint_1"]);
}

#[test]
fn protobuf_is_read_alike() {
    use super::protobuf::{descriptor_file, double, field, message, nested};
    const DOUBLE: u64 = 1;
    const TEXT: u64 = 9;
    const MESSAGE: u64 = 11;
    let axis = message(
        "Axis",
        &[
            field("name", 1, false, TEXT, ""),
            field("target", 2, false, DOUBLE, ""),
            field("actual", 3, false, DOUBLE, ""),
        ],
    );
    let arm = message("Arm", &[field("axes", 1, true, MESSAGE, ".our.Axis")]);
    let descriptors = descriptor_file("our.proto", "our", &[], &[axis, arm]);
    let mut log = Log::default();
    let channel = Channel::cdr("/arm", "our.Arm").with_schema("protobuf", descriptors).encoded("protobuf");
    log.add(channel, 0..SAMPLES, |k| {
        let axes = ["boom", "stick"].iter().enumerate().flat_map(|(j, name)| {
            nested(
                1,
                &[nested(1, name.as_bytes()), double(2, plan(k)[j]), double(3, measurement(k)[j])].concat(),
            )
        });
        axes.collect()
    });
    assert_both(&log, ["boom", "stick"]);
}

#[test]
fn json_is_read_alike() {
    let (mut log, mut listed) = (Log::default(), Log::default());
    log.add(Channel::json("/arm", "arm"), 0..SAMPLES, |k| {
        let [p, m] = [plan(k), measurement(k)];
        let text = format!(
            "{{\"boom\":{{\"target\":{:?},\"actual\":{:?}}},\"stick\":{{\"target\":{:?},\"actual\":{:?}}},\"mode\":3}}",
            p[0], m[0], p[1], m[1]
        );
        text.into_bytes()
    });
    listed.add(Channel::json("/arm", "arm"), 0..SAMPLES, |k| {
        let [p, m] = [plan(k), measurement(k)];
        let text = format!(
            "{{\"ts\":{k},\"axes\":[{{\"set\":{:?},\"act\":{:?}}},{{\"set\":{:?},\"act\":{:?}}}]}}",
            p[0], m[0], p[1], m[1]
        );
        text.into_bytes()
    });
    assert_both(&log, ["boom", "stick"]);
    assert_both(&listed, ["axes_0", "axes_1"]);
}

#[test]
fn json_is_dated_by_its_own_stamps_where_these_say_the_date() {
    const START_MS: i64 = 1_750_000_000_000;
    let stamps: [fn(i64) -> String; 5] = [
        |k| format!("\"timestamp\":{}", START_MS + 20 * k),
        |k| format!("\"ts\":{:.2}", (START_MS + 20 * k) as f64 / 1e3),
        |k| format!("\"time\":{}", (START_MS + 20 * k) * 1_000_000),
        |k| format!("\"@timestamp\":\"2025-06-15T15:06:{:02}.{:03}Z\"", 40 + k / 50, 20 * (k % 50)),
        |k| {
            format!(
                "\"header\":{{\"stamp\":{{\"sec\":{},\"nanosec\":{}}}}}",
                9 + k / 50,
                20_000_000 * (k % 50)
            )
        },
    ];
    for at in stamps {
        let mut log = Log::default();
        let channel = log.channel(Channel::json("/arm", "arm"));
        for k in 0..SAMPLES.min(900) {
            let [p, m] = [plan(k), measurement(k)];
            let text = format!("{{{},\"boom\":{{\"target\":{:?},\"actual\":{:?}}}}}", at(k), p[0], m[0]);
            // It comes late and in bursts.
            log.send(channel, stamp(k - k % 7) + 500_000_000, text.into_bytes());
        }
        let track = &read(&log).measured.tracks[0];
        assert!((track.t_s()[10] - 0.2).abs() < 1e-6, "{}: {:?}", at(0), &track.t_s()[..12]);
    }
}

#[test]
fn stamps_that_rest_or_are_missing_on_one_side_date_nothing() {
    for at in ["\"timestamp\":1750000000000,", "", "\"timestamp\":12.5,"] {
        let mut log = Log::default();
        let [targets, actuals] =
            ["/plc/target", "/plc/actual"].map(|topic| log.channel(Channel::json(topic, "arm")));
        for k in 0..SAMPLES {
            let [p, m] = [plan(k), measurement(k)];
            let stamped = format!("{{\"timestamp\":{},\"boom\":{:?}}}", 1_760_000_000_000 + 20 * k, p[0]);
            log.send(targets, stamp(k), stamped.into_bytes());
            log.send(actuals, stamp(k), format!("{{{at}\"boom\":{:?}}}", m[0]).into_bytes());
        }
        let recording = read(&log);
        for series in [&recording.planned, &recording.measured] {
            assert!((series.tracks[0].t_s()[10] - 0.2).abs() < 1e-6, "{at}");
            assert_eq!(series.tracks[0].len(), SAMPLES as usize, "{at}");
        }
    }
}

#[test]
fn angles_in_degrees_are_asked_for_with_the_line_that_reads_them() {
    let log = of("float32 boom_setpoint\nfloat32 boom_angle\n", |cdr, k| {
        cdr.f32(plan(k)[0].to_degrees() as f32 + 40.0);
        cdr.f32(measurement(k)[0].to_degrees() as f32 + 40.0);
    });
    let said = error(&log, &ReadOptions::default());
    assert!(
        said.contains("hydrotrace import ") && said.contains("run.mcap --degrees -o run-2.mcap`"),
        "{said}"
    );
}

#[test]
fn fields_without_such_words_stay_unread() {
    let log = of("float64 boom\nfloat64 stick\nfloat64 battery_target\n", |cdr, k| {
        [plan(k)[0], plan(k)[1], 3.0].into_iter().for_each(|value| cdr.f64(value));
    });
    assert!(error(&log, &ReadOptions::default()).contains("found no planned joint angles"));
}

#[test]
fn a_layout_of_such_a_log_is_that_of_the_log_made_of_it_by_the_line_that_is_printed() {
    let log = of("float64[2] q\nfloat64[2] q_d\n", |cdr, k| {
        measurement(k).iter().chain(&plan(k)).for_each(|value| cdr.f64(*value));
    });
    let folder = scratch();
    fs::write(folder.path().join("arm.mcap"), log.bytes(mcap::WriteOptions::new())).unwrap();
    let layout = |log: &str| {
        said(&run_line(folder.path(), &format!("export {log} --foxglove-layout layout.json --force")))
    };
    let (code, _, error) = layout("arm.mcap");
    assert_eq!(code, 1, "{error}");
    let line = error.split('`').nth(1).unwrap_or_else(|| panic!("{error}"));
    assert_eq!(line, "hydrotrace import arm.mcap -o run.mcap");
    said(&run_line(folder.path(), line.strip_prefix("hydrotrace ").unwrap()));
    let (code, _, error) = layout("run.mcap");
    assert_eq!(code, 3, "{error}");
    let text = fs::read_to_string(folder.path().join("layout.json")).unwrap();
    assert!(text.contains("/planned/joint_states.position[1]"), "{text}");
}
