//! Scenes to start from.

use clap::ValueEnum;

/// What a new scene is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Template {
    /// A column of water collapses and hits a wall or a post
    DamBreak,
    /// Water sloshes in a tank
    Tank,
    /// A drop of water hits a plate
    Impact,
}

impl Template {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::DamBreak, Self::Tank, Self::Impact];

    /// The commented scene, called `name`, in two dimensions or in three.
    pub fn text(self, dimension: usize, name: &str) -> String {
        let text = match (self, dimension) {
            (Self::DamBreak, 2) => include_str!("../../templates/dam-break-2d.toml"),
            (Self::DamBreak, _) => include_str!("../../templates/dam-break-3d.toml"),
            (Self::Tank, 2) => include_str!("../../templates/tank-2d.toml"),
            (Self::Tank, _) => include_str!("../../templates/tank-3d.toml"),
            (Self::Impact, 2) => include_str!("../../templates/impact-2d.toml"),
            (Self::Impact, _) => include_str!("../../templates/impact-3d.toml"),
        };
        text.replace("@NAME@", name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::setup::Setup;

    #[test]
    fn every_template_can_be_set_up_without_a_note_about_itself() {
        for template in Template::ALL {
            for dimension in [2, 3] {
                let text = template.text(dimension, "mine");
                let scene = Scene::parse("mine.toml", text, &[]).unwrap();
                assert_eq!((scene.name(), scene.dimension()), ("mine", dimension));
                let notes = match dimension {
                    2 => Setup::<2>::new(&scene).unwrap().notes(),
                    _ => Setup::<3>::new(&scene).unwrap().notes(),
                };
                // A gauge away from the water is dry at first, as it should be.
                let notes: Vec<_> = notes.iter().filter(|note| !note.starts_with("dry")).collect();
                assert!(notes.is_empty(), "{template:?} {dimension}: {notes:?}");
            }
        }
    }
}
