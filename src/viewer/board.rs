//! A blueprint with the properties of views that the crate rerun 0.36 cannot set: legends, eyes, ranges, columns.

use rerun::{
    Archetype, AsComponents, RecordingStream, RecordingStreamBuilder,
    blueprint::{Blueprint, BlueprintActivation, ContainerLike},
    log::LogMsg,
};

use super::ViewError;

/// The name of our recordings and blueprints in Rerun.
pub(super) const APPLICATION: &str = "hydrotrace";

type Batches = Vec<rerun::SerializedComponentBatch>;

/// Properties of views, by the entity of the blueprint that holds them.
#[derive(Default)]
pub(super) struct Board {
    properties: Vec<(String, Batches)>,
    blueprint: Blueprint,
}

impl Board {
    /// A view with a property.
    pub(super) fn with<P: Archetype + AsComponents>(
        &mut self,
        view: impl Into<ContainerLike>,
        property: &P,
    ) -> ContainerLike {
        let view = view.into();
        if let ContainerLike::View(inner) = &view {
            let path = format!("{}/{}", inner.blueprint_path(), P::name().short_name());
            self.properties.push((path, property.as_serialized_batches()));
        }
        view
    }

    /// The whole.
    pub(super) fn finish(mut self, of: impl FnOnce() -> Blueprint) -> Self {
        self.blueprint = of();
        self
    }

    /// Sends it to where a recording goes.
    pub(super) fn send(&self, rec: &RecordingStream) -> Result<(), ViewError> {
        let (layout, stored) = RecordingStreamBuilder::new(APPLICATION).memory()?;
        self.blueprint.send(&layout, BlueprintActivation::default())?;
        let mut messages = stored.take();
        let activation = messages.iter().find_map(|message| match message {
            LogMsg::BlueprintActivationCommand(command) => Some(command.clone()),
            _ => None,
        });
        let Some(activation) = activation else { return Ok(()) };
        let own = |message: &LogMsg| {
            *message.store_id() == activation.blueprint_id
                && !matches!(message, LogMsg::BlueprintActivationCommand(_))
        };
        messages.retain(own);
        let (beside, stored) = RecordingStreamBuilder::new(APPLICATION)
            .recording_id(activation.blueprint_id.recording_id().clone())
            .blueprint()
            .memory()?;
        beside.set_time_sequence("blueprint", 0);
        for (path, batches) in &self.properties {
            beside.log_serialized_batches(path.as_str(), false, batches.iter().cloned())?;
        }
        messages.extend(stored.take().into_iter().filter(|message| matches!(message, LogMsg::ArrowMsg(..))));
        rec.send_blueprint(messages, activation);
        Ok(())
    }
}
