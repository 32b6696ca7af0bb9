//! Which way a person faces, and how that is known.

use std::fmt;

use serde::{Deserialize, Serialize};

vocabulary! {
    /// Which way a person's front points in the picture, as somebody at the robot sees it.
    Facing {
        /// We see the face.
        Towards = "towards the robot",
        /// We see the face and the shoulder on our right: the person looks to our left.
        TowardsLeft = "towards the robot and to its left",
        /// In profile, looking to our left.
        Left = "to the robot's left",
        /// From behind and the side, looking to our left.
        AwayLeft = "away from the robot and to its left",
        /// We see the back.
        Away = "away from the robot",
        /// From behind and the side, looking to our right.
        AwayRight = "away from the robot and to its right",
        /// In profile, looking to our right.
        Right = "to the robot's right",
        /// We see the face and the shoulder on our left: the person looks to our right.
        TowardsRight = "towards the robot and to its right",
    }
}

vocabulary! {
    /// What tells a heading, the most trusted first.
    HeadingSource {
        /// A 3D label.
        Label = "label",
        /// The way it moves over frames.
        Motion = "motion",
        /// The attribute "facing" in the image, with the bearing.
        Facing = "facing",
        /// The line of the shoulders in the cloud, with something that tells front from back.
        BodyShape = "body shape",
    }
}
