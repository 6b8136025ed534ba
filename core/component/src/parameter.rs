//! Physical values of a scene by name.
use scene::Scene;

type Read = Box<dyn Fn(&Scene) -> f64 + Send + Sync>;
type Write = Box<dyn Fn(&mut Scene, f64) + Send + Sync>;

/// A physical value of the scene that can be set before the start.
pub struct Parameter {
    /// Name: the key of the scene where there is one.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// One sentence.
    pub description: String,
    read: Read,
    write: Write,
}

impl Parameter {
    /// A value with the functions that read it from a scene and write it into one.
    pub fn new(
        name: impl Into<String>,
        unit: &'static str,
        description: impl Into<String>,
        read: impl Fn(&Scene) -> f64 + Send + Sync + 'static,
        write: impl Fn(&mut Scene, f64) + Send + Sync + 'static,
    ) -> Self {
        Self {
            name: name.into(),
            unit,
            description: description.into(),
            read: Box::new(read),
            write: Box::new(write),
        }
    }

    /// The value in a scene.
    #[must_use]
    pub fn value(&self, scene: &Scene) -> f64 {
        (self.read)(scene)
    }

    /// Puts a value into a scene; [`Scene::check`] says afterwards whether it makes sense.
    pub fn set(&self, scene: &mut Scene, value: f64) {
        (self.write)(scene, value);
    }
}
