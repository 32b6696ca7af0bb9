//! Both engines on a tiny model of our own: y = relu(2 x - 1), and k + 1 in integers.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]
#![allow(clippy::print_stdout, reason = "tests say what they found and what they skip")]

mod onnxruntime;

use jrdb_perception::{Engine, EngineError, OrtEngine, RtenEngine, Tensor};

const TINY: &[u8] = include_bytes!("../testdata/tiny.onnx");

fn engines() -> Vec<Box<dyn Engine>> {
    let mut engines: Vec<Box<dyn Engine>> = vec![Box::new(RtenEngine::from_onnx(TINY).unwrap())];
    if let Some(library) = onnxruntime::find() {
        engines.push(Box::new(OrtEngine::from_onnx(&library, TINY, 1).unwrap()));
    }
    engines
}

fn floats(shape: &[usize], data: &[f32]) -> Tensor {
    Tensor::F32 { shape: shape.to_vec(), data: data.to_vec() }
}

fn integers(data: &[i64]) -> Tensor {
    Tensor::I64 { shape: vec![data.len()], data: data.to_vec() }
}

fn message(engine: &dyn Engine, inputs: &[(&str, &Tensor)], outputs: &[&str]) -> String {
    engine.run(inputs, outputs).unwrap_err().to_string()
}

#[test]
fn named_tensors_go_in_and_come_out_in_the_order_asked() {
    for engine in engines() {
        let (x, k) = (floats(&[1, 3], &[-1.0, 0.5, 3.0]), integers(&[6, -2]));
        let found = engine.run(&[("k", &k), ("x", &x)], &["k_next", "y"]).unwrap();
        assert_eq!(
            found,
            [integers(&[7, -1]), floats(&[1, 3], &[0.0, 0.0, 5.0])],
            "{}",
            engine.name()
        );
    }
}

#[test]
fn an_engine_serves_several_threads_at_once() {
    for engine in engines() {
        std::thread::scope(|scope| {
            for i in 0..8 {
                let engine = &engine;
                scope.spawn(move || {
                    let (x, k) = (floats(&[1, 3], &[i as f32; 3]), integers(&[0, i]));
                    let found = engine.run(&[("x", &x), ("k", &k)], &["k_next"]).unwrap();
                    assert_eq!(found, [integers(&[1, i + 1])]);
                });
            }
        });
    }
}

#[test]
fn wrong_names_are_told_with_the_right_ones() {
    for engine in engines() {
        let x = floats(&[1, 3], &[0.0; 3]);
        assert_eq!(
            message(&*engine, &[("z", &x)], &["y"]),
            r#"the model has no input "z"; it has ["x", "k"]"#
        );
        let k = integers(&[0, 0]);
        assert_eq!(
            message(&*engine, &[("x", &x), ("k", &k)], &["w"]),
            r#"the model has no output "w"; it has ["y", "k_next"]"#
        );
    }
}

#[test]
fn wrong_shapes_and_types_are_errors_and_the_engine_goes_on() {
    for engine in engines() {
        let (k, uneven) = (integers(&[0, 0]), floats(&[1, 3], &[0.0; 2]));
        assert_eq!(
            message(&*engine, &[("x", &uneven), ("k", &k)], &["y"]),
            r#"tensor "x" is f32 [1, 3] but holds 2 numbers"#
        );
        for wrong in [floats(&[1, 4], &[0.0; 4]), integers(&[1, 2, 3])] {
            let found = message(&*engine, &[("x", &wrong), ("k", &k)], &["y"]);
            assert_eq!(found, format!("{} failed to run the model", engine.name()));
        }
        let x = floats(&[1, 3], &[1.0; 3]);
        assert!(engine.run(&[("x", &x), ("k", &k)], &["y"]).is_ok());
    }
}

#[test]
fn a_missing_input_is_an_error() {
    for engine in engines() {
        let k = integers(&[0, 0]);
        assert_eq!(
            message(&*engine, &[("k", &k)], &["k_next"]),
            r#"expected the inputs ["x", "k"], found no "x""#
        );
    }
}

#[test]
fn rten_tells_of_integers_beyond_32_bits() {
    let engine = RtenEngine::from_onnx(TINY).unwrap();
    let (x, k) = (floats(&[1, 3], &[0.0; 3]), integers(&[1 << 40, 0]));
    assert_eq!(
        message(&engine, &[("x", &x), ("k", &k)], &["k_next"]),
        r#"expected integers of 32 bits in "k", found 1099511627776"#
    );
}

#[test]
fn garbage_is_no_model() {
    let cut = &TINY[..TINY.len() / 2];
    for bytes in [b"".as_slice(), b"garbage, not a model", cut] {
        let error = RtenEngine::from_onnx(bytes).unwrap_err().to_string();
        let found = format!("expected an ONNX model, found a file of {} bytes", bytes.len());
        assert!(error.starts_with(&found), "{error}");
        if let Some(library) = onnxruntime::find() {
            let error = OrtEngine::from_onnx(&library, bytes, 1).unwrap_err();
            assert_eq!(error.to_string(), "onnxruntime cannot load the model");
        }
    }
}

#[test]
fn a_process_has_one_library() {
    let Some(library) = onnxruntime::find() else { return };
    let again = jrdb_perception::OrtLibrary::load(library.path()).unwrap();
    assert_eq!(again.path(), library.path());
    let other = jrdb_perception::OrtLibrary::load("elsewhere.so".as_ref()).unwrap_err();
    assert!(matches!(other, EngineError::SecondLibrary { .. }));
}
