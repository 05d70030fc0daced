//! Random message types, written by an encoder of our own: what lies between the wanted fields
//! must not move them.

use proptest::prelude::*;

use super::{
    cdr::{Cdr, KINDS, Kind},
    file::Channel,
    *,
};

#[derive(Debug, Clone)]
enum Shape {
    /// Index into `NUMBERS`.
    Number(usize),
    Text(String),
    Struct(Vec<Shape>),
    Array(Vec<Shape>),
    Sequence(Vec<Shape>, Box<Shape>),
}

const NUMBERS: [(&str, &str); 13] = [
    ("bool", "boolean"),
    ("byte", "octet"),
    ("char", "char"),
    ("int8", "int8"),
    ("uint8", "uint8"),
    ("int16", "int16"),
    ("uint16", "unsigned short"),
    ("int32", "long"),
    ("uint32", "uint32"),
    ("int64", "long long"),
    ("uint64", "uint64"),
    ("float32", "float"),
    ("float64", "double"),
];

fn write_number(cdr: &mut Cdr, number: usize) {
    match number {
        0..=4 => cdr.u8(number as u8),
        5 | 6 => cdr.u16(0x0102),
        7 => cdr.i32(-3),
        8 => cdr.u32(0x0102_0304),
        11 => cdr.f32(1.5),
        12 => cdr.f64(2.5),
        _ => cdr.u64(0x0102_0304_0506_0708),
    }
}

impl Shape {
    fn write(&self, cdr: &mut Cdr) {
        match self {
            Self::Number(number) => write_number(cdr, *number),
            Self::Text(text) => cdr.text(text),
            Self::Struct(fields) => cdr.record(|cdr| {
                fields.iter().for_each(|field| field.write(cdr));
                if fields.is_empty() {
                    cdr.u8(0);
                }
            }),
            Self::Array(items) if items.iter().all(|item| matches!(item, Self::Number(_))) => {
                items.iter().for_each(|item| item.write(cdr));
            }
            Self::Array(items) => cdr.array(items, |cdr, item| item.write(cdr)),
            Self::Sequence(items, of) if matches!(**of, Self::Number(_)) => {
                cdr.u32(items.len() as u32);
                items.iter().for_each(|item| item.write(cdr));
            }
            Self::Sequence(items, _) => cdr.list(items, |cdr, item| item.write(cdr)),
        }
    }
}

/// Texts of structs by name; structs of one number count as different types.
#[derive(Default)]
struct Texts {
    msg: Vec<(String, String)>,
    idl: Vec<(String, String)>,
}

impl Texts {
    fn define(&mut self, name: &str, fields: &[(String, Shape)]) {
        let at = self.msg.len();
        self.msg.push((name.to_owned(), String::new()));
        self.idl.push((name.to_owned(), String::new()));
        let (mut msg, mut idl) = (String::new(), String::new());
        for (field, shape) in fields {
            let (of, msg_after, idl_before, idl_after, idl_array) = match shape {
                Shape::Array(items) => {
                    (&items[0], format!("[{}]", items.len()), "", "", format!("[{}]", items.len()))
                }
                Shape::Sequence(_, of) => (&**of, "[]".to_owned(), "sequence<", ">", String::new()),
                other => (other, String::new(), "", "", String::new()),
            };
            let (msg_type, idl_type) = match of {
                Shape::Number(number) => (NUMBERS[*number].0.to_owned(), NUMBERS[*number].1.to_owned()),
                Shape::Text(_) => ("string".to_owned(), "string".to_owned()),
                Shape::Struct(fields) => {
                    let name = format!("T{}", self.msg.len());
                    let fields: Vec<_> =
                        fields.iter().enumerate().map(|(k, s)| (format!("f{k}"), s.clone())).collect();
                    self.define(&name, &fields);
                    (name.clone(), format!("x::msg::{name}"))
                }
                nested => unreachable!("{nested:?}"),
            };
            msg += &format!("{msg_type}{msg_after} {field}  # text\n");
            idl += &format!("{idl_before}{idl_type}{idl_after} {field}{idl_array};\n");
        }
        if fields.is_empty() {
            idl += "octet structure_needs_at_least_one_member;\n";
        }
        self.msg[at].1 = msg;
        self.idl[at].1 = idl;
    }

    fn ros2msg(&self) -> String {
        let rule = "=".repeat(80);
        let parts: Vec<String> = self
            .msg
            .iter()
            .enumerate()
            .map(
                |(k, (name, text))| {
                    if k == 0 { text.clone() } else { format!("{rule}\nMSG: x/{name}\n{text}") }
                },
            )
            .collect();
        parts.concat()
    }

    fn ros2idl(&self) -> String {
        let rule = "=".repeat(80);
        self.idl.iter().map(|(name, text)| {
            format!("{rule}\nIDL: x/msg/{name}\nmodule x {{ module msg {{ struct {name} {{\n{text}}}; }}; }};\n")
        }).collect()
    }
}

fn leaf() -> impl Strategy<Value = Shape> {
    prop_oneof![(0..NUMBERS.len()).prop_map(Shape::Number), "[a-z]{0,9}".prop_map(Shape::Text)]
}

/// Elements of lists differ in their texts and the lengths of their lists, never in type.
fn shape() -> impl Strategy<Value = Shape> {
    leaf().prop_recursive(3, 24, 4, |inner| {
        let single = prop_oneof![leaf(), prop::collection::vec(inner, 0..4).prop_map(Shape::Struct)];
        prop_oneof![
            single.clone(),
            (single.clone(), 1_usize..4).prop_map(|(of, n)| Shape::Array(vec![of; n])),
            (single, 0_usize..4).prop_map(|(of, n)| Shape::Sequence(vec![of.clone(); n], Box::new(of))),
        ]
    })
}

fn name_all(shapes: &[Shape], prefix: &str) -> Vec<(String, Shape)> {
    shapes.iter().enumerate().map(|(k, shape)| (format!("{prefix}{k}"), shape.clone())).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn fields_nobody_wants_move_none_that_somebody_does(
        parts in prop::collection::vec(prop::collection::vec(shape(), 0..4), 4),
        kind in 0..KINDS.len(),
        idl in any::<bool>(),
    ) {
        let kind = KINDS[kind];
        let mut fields = name_all(&parts[0], "a");
        let names = Shape::Sequence(NAMES.map(|name| Shape::Text(name.into())).to_vec(), Box::new(Shape::Text(String::new())));
        fields.push(("names".into(), names));
        fields.extend(name_all(&parts[1], "b"));
        // Written apart, because its numbers matter.
        let probe = fields.len();
        fields.push(("angle".into(), Shape::Sequence(vec![], Box::new(Shape::Number(12)))));
        fields.extend(name_all(&parts[2], "c"));
        let mut texts = Texts::default();
        texts.define("Root", &fields);
        let mut log = Log::of_plan();
        let channel = Channel::cdr("/m", "x/msg/Root");
        let channel = if idl { channel.with_schema("ros2idl", texts.ros2idl()) } else { channel.with_schema("ros2msg", texts.ros2msg()) };
        log.add(channel, 0..3, |k| Cdr::message(kind, |cdr| {
            for (at, (_, shape)) in fields.iter().enumerate() {
                if at == probe { cdr.f64s(&measurement(k)) } else { shape.write(cdr) }
            }
        }));
        let bytes = log.bytes(mcap::WriteOptions::new().compression(None));
        let recording = hydrotrace::log::survey_bytes(&bytes, &options(&[], &["/m:angle"], &[])).unwrap().recording;
        // A list of nothing but empty structs has no least size that tells its forms apart.
        let recording = recording.map_err(|error| TestCaseError::fail(format!("{error} {kind:?}\n{}", texts.ros2msg())))?;
        prop_assert_eq!(joints(&recording.measured), NAMES);
        for (j, track) in recording.measured.tracks.iter().enumerate() {
            for k in 0..3 {
                prop_assert_eq!(track.position()[k as usize], measurement(k)[j], "{:?}\n{}", kind, texts.ros2msg());
            }
        }
    }
}

#[test]
fn a_random_type_of_each_kind_is_written_as_the_standard_says() {
    // One message worked out by hand, so that encoder and decoder cannot be wrong alike.
    let message = Cdr::message(Kind::LittleEndian, |cdr| {
        cdr.u8(7);
        cdr.texts(&["ab"]);
        cdr.f64s(&[1.0]);
    });
    let by_hand = [
        &[0, 1, 0, 0][..],
        &[7, 0, 0, 0],
        &[1, 0, 0, 0, 3, 0, 0, 0, b'a', b'b', 0, 0],
        &[1, 0, 0, 0, 0, 0, 0, 0],
        &[0, 0, 0, 0],
        &1.0_f64.to_le_bytes(),
    ];
    // 4 + 12 + 4 = 20 bytes before the number, which starts at the next multiple of eight.
    let by_hand = [by_hand[0], by_hand[1], by_hand[2], &by_hand[3][..4], by_hand[4], by_hand[5]].concat();
    assert_eq!(message, by_hand);
    let xcdr2 = Cdr::message(Kind::Xcdr2, |cdr| {
        cdr.u8(7);
        cdr.texts(&["ab"]);
        cdr.f64s(&[1.0]);
    });
    let by_hand = [
        &[0, 7, 0, 0][..],
        &[7, 0, 0, 0],
        &[11, 0, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0, b'a', b'b', 0, 0],
        &[1, 0, 0, 0],
        &1.0_f64.to_le_bytes(),
    ];
    assert_eq!(xcdr2, by_hand.concat());
}

#[test]
fn forms_of_xcdr2_are_told_apart_by_the_sizes_of_lists() {
    for kind in [Kind::Xcdr2, Kind::Xcdr2NoSizes] {
        let mut log = Log::of_plan();
        let schema = "string[] empty\nfloat64[] angle\n";
        log.add(Channel::cdr("/m", "x/msg/M").with_schema("ros2msg", schema), 0..3, |_| {
            // Read with sizes that are not there, this is two empty texts and no angles.
            Cdr::message(kind, |cdr| {
                cdr.texts(&[]);
                cdr.f64s(&[0.0, 0.0]);
            })
        });
        let recording = read_with(&log, &options(&[], &["/m:angle"], &NAMES));
        assert_eq!(joints(&recording.measured), NAMES, "{kind:?}");
    }
}
