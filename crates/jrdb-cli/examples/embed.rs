//! The README's example of the library. It asks about one frame, read from the folder it runs in: `rig.yaml`, `panorama.png`,
//! `sweep.pcd` for the first LiDAR of the rig, and `models/` as `jrdb models fetch` leaves it.

#![allow(clippy::print_stdout, reason = "an example prints")]

use std::path::Path;

use jrdb_dataset::cloud::{Fields, read};
use jrdb_models::{Perception, PerceptionOptions};
use jrdb_pipeline::{Frame, Pipeline, PipelineConfig, Robot};
use jrdb_types::FrameId;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let robot = Robot::new(jrdb_dataset::rig::read("rig.yaml".as_ref())?, None)?;
    let lidar = robot.rig().lidars.first().ok_or("rig.yaml names no LiDAR")?.name.clone();
    let perception = Perception::open("light", &PerceptionOptions::models("models"))?;
    let pipeline = Pipeline::new(robot, perception, PipelineConfig::default());

    let id = FrameId { sequence: "now".into(), frame: 0 };
    let image = jrdb_dataset::read_image(Path::new("panorama.png"))?;
    let sweeps = vec![read(Path::new("sweep.pcd"), &lidar, Fields::Positions)?];

    let scene = pipeline.see(Frame::new(id, image, sweeps))?;
    let answer = scene.ask("Who is the woman left of a child?")?;
    println!("{}", jrdb_render::explain(&answer, 6));
    Ok(())
}
