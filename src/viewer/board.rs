//! A blueprint with the properties of views that the crate rerun 0.36 cannot set: legends, eyes, ranges, columns.

use rerun::{
    ApplicationId, Archetype, AsComponents, RecordingStream, RecordingStreamBuilder,
    blueprint::{Blueprint, BlueprintActivation, ContainerLike},
    external::{re_log_encoding::Encoder, re_log_types::BlueprintActivationCommand},
    log::LogMsg,
};

use super::ViewError;

pub(super) const APPLICATION: &str = "hydrotrace";

type Batches = Vec<rerun::SerializedComponentBatch>;
/// A blueprint, and what makes a viewer use it.
type Activated = (Vec<LogMsg>, BlueprintActivationCommand);

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

    pub(super) fn finish(mut self, of: impl FnOnce() -> Blueprint) -> Self {
        self.blueprint = of();
        self
    }

    /// Sends it to where a recording goes.
    pub(super) fn send(&self, rec: &RecordingStream) -> Result<(), ViewError> {
        if let Some((messages, activation)) = self.messages(&APPLICATION.into())? {
            rec.send_blueprint(messages, activation);
        }
        Ok(())
    }

    /// The bytes of a file that a viewer opens beside the recordings of an application.
    pub(super) fn bytes(&self, application: &ApplicationId) -> Result<Vec<u8>, ViewError> {
        let Some((mut messages, activation)) = self.messages(application)? else { return Ok(Vec::new()) };
        messages.push(LogMsg::BlueprintActivationCommand(activation));
        Encoder::encode(messages.into_iter().map(Ok)).map_err(|error| ViewError::Blueprint(Box::new(error)))
    }

    fn messages(&self, application: &ApplicationId) -> Result<Option<Activated>, ViewError> {
        let (layout, stored) = RecordingStreamBuilder::new(application.clone()).memory()?;
        self.blueprint.send(&layout, BlueprintActivation::default())?;
        let mut messages = stored.take();
        let activation = messages.iter().find_map(|message| match message {
            LogMsg::BlueprintActivationCommand(command) => Some(command.clone()),
            _ => None,
        });
        let Some(activation) = activation else { return Ok(None) };
        let own = |message: &LogMsg| {
            *message.store_id() == activation.blueprint_id
                && !matches!(message, LogMsg::BlueprintActivationCommand(_))
        };
        messages.retain(own);
        let (beside, stored) = RecordingStreamBuilder::new(application.clone())
            .recording_id(activation.blueprint_id.recording_id().clone())
            .blueprint()
            .memory()?;
        beside.set_time_sequence("blueprint", 0);
        for (path, batches) in &self.properties {
            beside.log_serialized_batches(path.as_str(), false, batches.iter().cloned())?;
        }
        messages.extend(stored.take().into_iter().filter(|message| matches!(message, LogMsg::ArrowMsg(..))));
        Ok(Some((messages, activation)))
    }
}
