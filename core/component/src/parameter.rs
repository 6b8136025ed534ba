//! Physical values of a scene by name.
use scene::Scene;

type Read = Box<dyn Fn(&Scene) -> f64 + Send + Sync>;
type Write = Box<dyn Fn(&mut Scene, f64) + Send + Sync>;

/// Physical value of the scene that can be set before the start.
pub struct Parameter {
    /// Name: the key of the scene, if there is one.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// One sentence.
    pub description: String,
    read: Read,
    write: Write,
}

impl Parameter {
    /// Value with the functions that read it from a scene and write it into a scene.
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

    /// Value in a scene.
    #[must_use]
    pub fn value(&self, scene: &Scene) -> f64 {
        (self.read)(scene)
    }

    /// Writes a value into a scene; [`Scene::check`] judges the value afterwards.
    pub fn set(&self, scene: &mut Scene, value: f64) {
        (self.write)(scene, value);
    }
}
