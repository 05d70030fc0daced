//! Where Rerun's MCAP reader puts a number: its entity, and how a line is drawn from it.

use std::fmt::Write as _;

use rerun::{
    Color, EntityPath, EntityPathPart, SeriesLines,
    external::re_sdk_types::{
        Visualizer,
        blueprint::{
            components::VisualizerComponentMapping, datatypes::VisualizerComponentMapping as Mapping,
        },
    },
};

use crate::log::{DrawnTopic, Line, Step};

/// A number as Rerun has it.
pub(super) struct Drawn {
    pub(super) entity: String,
    how: How,
}

enum How {
    /// One of the scalars of the entity.
    Among { place: usize, places: usize },
    /// In a whole message: its component, and the way to the number.
    Within { component: String, selector: String },
}

impl Drawn {
    /// `None` if Rerun does not read such messages.
    pub(super) fn of(topic: &DrawnTopic, line: &Line) -> Option<Self> {
        let entity = EntityPath::from(topic.topic.as_str());
        let read = (topic.encoding.as_str(), topic.schema_encoding.as_str());
        let among = |place: usize| How::Among { place, places: line.places.max(place + 1) };
        let (entity, how) = match (read, topic.type_name.as_str(), &line.path[..]) {
            (("cdr", "ros2msg"), "sensor_msgs/msg/JointState", [Step::Field(field), Step::Place(place)]) => {
                (entity / EntityPathPart::new(field.as_str()), among(*place))
            }
            (("cdr", "ros2msg"), "std_msgs/msg/Float64MultiArray", [_, Step::Place(place)]) => {
                (entity, among(*place))
            }
            (("cdr", "ros2msg") | ("protobuf", "protobuf"), name, path) => {
                let component = format!("{}:message", name.replace('/', "."));
                (entity, How::Within { component, selector: selector(path)? })
            }
            _ => return None,
        };
        Some(Self { entity: entity.to_string(), how })
    }

    /// Whether other lines of its entity are hidden.
    pub(super) fn hides(&self) -> bool {
        matches!(self.how, How::Among { places, .. } if places > 1)
    }

    /// How it becomes a line.
    pub(super) fn visualizer(&self, name: &str, color: Color) -> Visualizer {
        match &self.how {
            How::Among { place, places } => {
                let at = |mark: bool| move |one: usize| (one == *place) == mark;
                let shown = (0..*places).map(at(true));
                let lines = SeriesLines::new().with_visible_series(shown);
                Visualizer::from(&lines.with_colors(vec![color; *places]))
            }
            How::Within { component, selector } => {
                let lines = SeriesLines::new().with_names([name]).with_colors([color]);
                let scalars = Mapping::new_source_component_with_selector(
                    "Scalars:scalars",
                    component.as_str(),
                    selector.as_str(),
                );
                Visualizer::from(&lines).with_mappings([VisualizerComponentMapping(scalars)])
            }
        }
    }
}

/// The way through a message, as Rerun spells it; `None` if a place changes or a name cannot be spelt.
fn selector(path: &[Step]) -> Option<String> {
    let mut text = String::new();
    for step in path {
        match step {
            Step::Field(name) if name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') => {
                text.push('.');
                text.push_str(name);
            }
            Step::Place(place) | Step::Named { place: Some(place), .. } => {
                let _ = write!(text, "[{place}]");
            }
            Step::Field(_) | Step::Named { place: None, .. } => return None,
        }
    }
    Some(text)
}
