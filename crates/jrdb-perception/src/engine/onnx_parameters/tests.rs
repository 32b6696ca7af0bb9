//! Hand-made files with everything that misleads a count.

use super::super::onnx_wire::written::{bytes, number};
use super::*;
use proptest::prelude::*;
use std::io::Cursor;

const FLOAT: u64 = 1;
const UINT8: u64 = 2;
const INT8: u64 = 3;
const INT32: u64 = 6;
const INT64: u64 = 7;
const FLOAT16: u64 = 10;
const INT4: u64 = 22;

fn text(field: u64, value: &str) -> Vec<u8> {
    bytes(field, value.as_bytes())
}

/// A tensor whose bytes are given.
fn tensor(name: &str, kind: u64, dims: &[u64], raw: &[u8]) -> Vec<u8> {
    let dims: Vec<u8> = dims.iter().flat_map(|&length| number(1, length)).collect();
    [dims, number(2, kind), text(8, name), bytes(9, raw)].concat()
}

/// 32-bit floats `seed`, `seed + 1`, …
fn floats(name: &str, dims: &[u64], seed: u32) -> Vec<u8> {
    let count = dims.iter().product::<u64>() as u32;
    let raw: Vec<u8> = (0..count).flat_map(|i| ((seed + i) as f32).to_le_bytes()).collect();
    tensor(name, FLOAT, dims, &raw)
}

fn initializer(tensor: &[u8]) -> Vec<u8> {
    bytes(5, tensor)
}

fn weight(name: &str, dims: &[u64], seed: u32) -> Vec<u8> {
    initializer(&floats(name, dims, seed))
}

fn node(operator: &str, inputs: &[&str], attributes: &[Vec<u8>]) -> Vec<u8> {
    let inputs: Vec<u8> = inputs.iter().flat_map(|name| text(1, name)).collect();
    let attributes: Vec<u8> = attributes.iter().flat_map(|one| bytes(5, one)).collect();
    bytes(1, &[inputs, text(2, "out"), text(4, operator), attributes].concat())
}

fn int(name: &str, value: u64) -> Vec<u8> {
    [text(1, name), number(3, value)].concat()
}

fn of(graph: &[Vec<u8>]) -> Result<Parameters, EngineError> {
    let model = bytes(7, &graph.concat());
    count_parameters(Cursor::new(&model), model.len() as u64)
}

fn count(graph: &[Vec<u8>]) -> u64 {
    of(graph).unwrap().count()
}

#[test]
fn a_weight_counts_the_product_of_its_axes() {
    let found = of(&[weight("w", &[3, 4], 0), weight("b", &[4], 0)]).unwrap();
    assert_eq!((found.count(), found.bytes()), (16, 64));
    assert_eq!(found.by_type(), BTreeMap::from([("float32".into(), 16)]));
}

#[test]
fn single_numbers_shapes_and_indices_are_not_parameters() {
    let shape = initializer(&tensor("shape", INT64, &[2], &[0; 16]));
    let mask = initializer(&tensor("mask", 9, &[4], &[1; 4]));
    assert_eq!(count(&[weight("eps", &[], 0), weight("one", &[1], 0), shape, mask]), 0);
}

#[test]
fn weights_in_constant_nodes_count_and_values_that_fill_do_not() {
    let value = |tensor: &[u8]| [text(1, "value"), bytes(5, tensor)].concat();
    let two_by_three = floats("", &[2, 3], 0);
    assert_eq!(count(&[node("Constant", &[], &[value(&two_by_three)])]), 6);
    assert_eq!(count(&[node("ConstantOfShape", &[], &[value(&two_by_three)])]), 0);
    let list = [text(1, "value_floats"), bytes(7, &[0; 20])].concat();
    assert_eq!(count(&[node("Constant", &[], &[list])]), 5);
}

#[test]
fn weights_in_branches_and_functions_count() {
    let branch = |seed| bytes(6, &weight("w", &[2, 3], seed));
    let branches = [
        [text(1, "then_branch"), branch(0)].concat(),
        [text(1, "else_branch"), branch(100)].concat(),
    ];
    assert_eq!(count(&[node("If", &["condition"], &branches)]), 12);
    let value = [text(1, "value"), bytes(5, &floats("", &[2, 3], 0))].concat();
    let constant = [text(2, "c"), text(4, "Constant"), bytes(5, &value)].concat();
    let model = [bytes(7, &[]), bytes(25, &bytes(7, &constant))].concat();
    let found = count_parameters(Cursor::new(&model), model.len() as u64).unwrap();
    assert_eq!(found.count(), 6);
}

#[test]
fn the_same_weight_in_both_branches_counts_once() {
    let branch = || bytes(6, &[weight("w", &[2, 3], 0), weight("b", &[3], 0)].concat());
    let branches = ["then_branch", "else_branch"].map(|name| [text(1, name), branch()].concat());
    assert_eq!(count(&[node("If", &["condition"], &branches)]), 9);
}

#[test]
fn tied_matrices_count_once_even_when_one_is_transposed() {
    let transposed: Vec<u8> = (0..3)
        .flat_map(|column| (0..5).map(move |row| row * 3 + column))
        .flat_map(|i| (i as f32).to_le_bytes())
        .collect();
    let embedding = weight("embed", &[5, 3], 0);
    let head = initializer(&tensor("head", FLOAT, &[3, 5], &transposed));
    assert_eq!(count(&[embedding.clone(), weight("again", &[5, 3], 0), head]), 15);
    assert_eq!(count(&[embedding.clone(), weight("head", &[3, 5], 0)]), 30);
    assert_eq!(count(&[embedding, weight("other", &[5, 3], 1)]), 30);
}

#[test]
fn equal_vectors_and_uniform_matrices_of_other_names_are_other_weights() {
    let zeros = |name| initializer(&tensor(name, FLOAT, &[2, 2], &[0; 16]));
    assert_eq!(count(&[weight("norm1", &[4], 0), weight("norm2", &[4], 0)]), 8);
    assert_eq!(count(&[zeros("a"), zeros("b")]), 8);
    assert_eq!(count(&[zeros("a"), zeros("a")]), 4);
}

#[test]
fn a_merged_decoder_beside_the_two_that_it_is_made_of_counts_once() {
    let parts = [weight("w", &[4, 5], 0), weight("b", &[5], 7)];
    let graphs = [&parts[..], &parts, &[weight("other", &[4, 5], 100)]];
    let graphs = graphs.map(|graph| of(graph).unwrap());
    assert_eq!(Parameters::union(&graphs).count(), 45);
}

#[test]
fn packed_weights_count_unpacked_without_scales_and_zero_points() {
    let (k, n) = (64, 3);
    let packed: Vec<u8> = (0..96).collect();
    let graph = |k| {
        let attributes = [int("K", k), int("N", n), int("bits", 4)];
        vec![
            node("MatMulNBits", &["x", "w", "scales", "zeros"], &attributes),
            initializer(&tensor("w", UINT8, &[3, 2, 16], &packed)),
            weight("scales", &[6], 0),
            initializer(&tensor("zeros", UINT8, &[3], &[8; 3])),
        ]
    };
    let found = of(&graph(k)).unwrap();
    assert_eq!((found.count(), found.bytes()), (k * n, 96));
    assert_eq!(found.by_type(), BTreeMap::from([("4-bit".into(), k * n)]));
    let error = of(&graph(1000)).unwrap_err().to_string();
    assert!(error.contains("expected at least 3000 numbers of 4 bits in \"w\""), "{error}");
    let error = of(&[node("MatMulNBits", &["x", "w"], &[])]).unwrap_err().to_string();
    assert!(error.contains("expected the attributes K and N of MatMulNBits"), "{error}");
}

#[test]
fn a_quantised_table_of_words_counts_its_numbers_not_its_bytes() {
    let gather = || node("GatherBlockQuantized", &["w", "ids", "scales"], &[int("bits", 4)]);
    let bytes: Vec<u8> = (0..32).collect();
    let packed = initializer(&tensor("w", UINT8, &[4, 8], &bytes));
    assert_eq!(count(&[gather(), packed, weight("scales", &[4], 0)]), 64);
    let typed = initializer(&tensor("w", INT4, &[4, 16], &bytes));
    assert_eq!(count(&[gather(), typed]), 64);
}

#[test]
fn quantised_weights_and_biases_count_without_scales_and_zero_points() {
    let dequantise = |name: &str| {
        node("DequantizeLinear", &[name, &format!("{name}.s"), &format!("{name}.z")], &[])
    };
    let graph = [
        dequantise("w"),
        dequantise("b"),
        initializer(&tensor("w", INT8, &[2, 3], &[1, 2, 3, 4, 5, 6])),
        weight("w.s", &[3], 0),
        initializer(&tensor("w.z", INT8, &[3], &[0; 3])),
        initializer(&tensor("b", INT32, &[3], &[1; 12])),
        initializer(&tensor("ids", INT32, &[3], &[1; 12])),
    ];
    let types = BTreeMap::from([("int32".into(), 3), ("int8".into(), 6)]);
    assert_eq!(of(&graph).unwrap().by_type(), types);
}

#[test]
fn scales_of_dynamic_quantisation_are_known_by_their_names() {
    let graph = [
        initializer(&tensor("w_quantized", INT8, &[2, 3], &[1, 2, 3, 4, 5, 6])),
        weight("w_scale", &[3], 0),
        weight("v_scale", &[3], 0),
    ];
    assert_eq!(count(&graph), 9);
}

#[test]
fn sizes_of_a_scaled_picture_are_not_parameters() {
    let graph = [node("Resize", &["x", "", "sizes"], &[]), weight("sizes", &[4], 1)];
    assert_eq!(count(&graph), 0);
}

#[test]
fn half_precision_in_typed_fields_counts() {
    let dims = [number(1, 2), number(1, 3)].concat();
    let numbers = bytes(5, &[1, 2, 3, 4, 5, 6]);
    let half = [dims, number(2, FLOAT16), numbers, text(8, "w")].concat();
    assert_eq!(count(&[initializer(&half)]), 6);
}

/// A weight of 32-bit floats in a file of its own.
fn external(name: &str, dims: &[u64], location: &str, offset: u64, length: u64) -> Vec<u8> {
    let entry = |key: &str, value: &str| bytes(13, &[text(1, key), text(2, value)].concat());
    let dims: Vec<u8> = dims.iter().flat_map(|&length| number(1, length)).collect();
    let place = [
        entry("location", location),
        entry("offset", &offset.to_string()),
        entry("length", &length.to_string()),
    ];
    initializer(&[dims, number(2, FLOAT), text(8, name), place.concat(), number(14, 1)].concat())
}

#[test]
fn weights_in_other_files_count_by_their_header_and_once_by_their_place() {
    let huge = 1 << 20;
    let at = |name, offset| external(name, &[huge, 1024], "w.data", offset, huge * 4096);
    let found = of(&[at("a", 0), at("tied", 0), at("b", huge * 4096)]).unwrap();
    assert_eq!(found.count(), 2 * huge * 1024);
    assert_eq!(found.bytes(), 2 * huge * 4096);
}

#[test]
fn equal_weights_in_other_files_are_found_by_a_few_numbers() {
    let table: Vec<u8> = (0..12_u8).flat_map(|i| f32::from(i).to_le_bytes()).collect();
    let shifted = [&[0; 8][..], &table].concat();
    let open = |location: &str| match location {
        "a.data" => Ok(Cursor::new(shifted.clone())),
        "b.data" => Ok(Cursor::new(table.clone())),
        _ => Err(std::io::ErrorKind::NotFound.into()),
    };
    let found = of(&[
        external("a", &[4, 3], "a.data", 8, 48),
        external("b", &[4, 3], "b.data", 0, 48),
        external("absent", &[4, 3], "c.data", 0, 48),
        external("too short", &[4, 3], "b.data", 8, 48),
    ]);
    let found = found.unwrap();
    assert_eq!(found.count(), 48);
    assert_eq!(found.with_external_files(open).count(), 36);
}

#[test]
fn what_is_no_model_or_breaks_off_is_refused() {
    let model = bytes(7, &weight("w", &[2, 3], 0));
    for broken in [&b""[..], b"hello, world", &model[..model.len() - 1]] {
        let error = count_parameters(Cursor::new(broken), broken.len() as u64).unwrap_err();
        assert!(error.to_string().starts_with("expected an ONNX model"), "{error}");
    }
}

#[test]
fn a_shape_that_the_bytes_do_not_have_is_refused() {
    let error = |graph: Vec<u8>| of(&[graph]).unwrap_err().to_string();
    let short = error(initializer(&tensor("w", FLOAT, &[2, 3], &[0; 20])));
    assert_eq!(short, "expected 24 bytes in \"w\", float32 [2, 3], found 20");
    let negative = error(initializer(&tensor("w", FLOAT, &[u64::MAX, 3], &[])));
    assert_eq!(negative, "expected a shape of \"w\", found [-1, 3]");
    let endless = error(external("w", &[1 << 40, 1 << 40], "w.data", 0, 4));
    assert!(endless.starts_with("expected a shape of \"w\""), "{endless}");
}

#[test]
fn graphs_that_lie_too_deep_are_refused() {
    let nested = (0..20).fold(Vec::new(), |inner: Vec<u8>, _| {
        node("If", &[], &[[text(1, "then_branch"), bytes(6, &inner)].concat()])
    });
    let error = of(&[nested]).unwrap_err().to_string();
    assert!(error.contains("at most 16 graphs"), "{error}");
}

/// A file with everything that is read.
fn sound() -> Vec<u8> {
    let value = [text(1, "value"), bytes(5, &floats("", &[4, 3], 0))].concat();
    let branch = [text(1, "then_branch"), bytes(6, &weight("w", &[2, 3], 0))].concat();
    let packing = [int("K", 4), int("N", 3), int("bits", 4)];
    let graph = [
        node("Constant", &[], &[value]),
        node("If", &["condition"], &[branch]),
        node("MatMulNBits", &["x", "p", "s"], &packing),
        initializer(&tensor("p", UINT8, &[3, 1, 2], &[1, 2, 3, 4, 5, 6])),
        external("e", &[4, 3], "w.data", 8, 48),
    ];
    bytes(7, &graph.concat())
}

proptest! {
    #[test]
    fn changed_bytes_are_counted_or_refused(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut model = sound();
        for (place, byte) in changes {
            let place = place.index(model.len());
            model[place] = byte;
        }
        if let Err(error) = count_parameters(Cursor::new(&model), model.len() as u64) {
            prop_assert!(error.to_string().starts_with("expected"), "{error}");
        }
    }
}
