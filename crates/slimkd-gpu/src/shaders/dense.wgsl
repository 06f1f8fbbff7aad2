// 4-byte nodes and coded leaves at any byte: layout/dense/mod.rs and leaf.rs. Twin: twin/nodes.rs.

struct Leaf { codes: u32, left: u32, next: u32, run: u32 }

// The 4 bytes at an address of the tree.
fn bytes_at(address: u32) -> u32 {
    let at = params.nodes + (address >> 2u);
    let shift = (address & 3u) * 8u;
    let low = word(at);
    if shift == 0u { return low; }
    return (low >> shift) | (word(at + 1u) << (32u - shift));
}

fn is_leaf(lower: u32) -> bool { return (lower & 3u) == 3u; }

fn node_lower(address: u32) -> u32 { return bytes_at(address); }

fn inner(address: u32, lower: u32) -> Inner {
    let split = bitcast<f32>((lower >> 9u) | 0x3f800000u);
    let near = (lower >> 2u) & 0x1ffu;
    if near != 0u { return Inner(lower & 3u, split, address + 4u, address + near, NONE); }
    return Inner(lower & 3u, split, address + 8u, address + bytes_at(address + 4u), NONE);
}

fn open_leaf(address: u32, lower: u32) -> Leaf {
    let many = (1u << params.count_bits) - 1u;
    let count = (lower >> 2u) & many;
    let first = (lower >> (2u + params.count_bits)) & params.id_mask;
    let codes = address + params.header_bytes;
    if count == many { return Leaf(codes + 4u, bytes_at(codes), first, 1u); }
    return Leaf(codes, count, first, 1u);
}

fn next_id(leaf: ptr<function, Leaf>) -> u32 {
    let id = (*leaf).next;
    (*leaf).left -= 1u;
    (*leaf).run -= 1u;
    (*leaf).next = id + 1u;
    if (*leaf).run == 0u && (*leaf).left > 0u {
        let code = bytes_at((*leaf).codes);
        let field = (code >> 3u) & 31u;
        var gap = field;
        var size = 1u;
        if field == 29u {
            gap = 29u + ((code >> 8u) & 0xffu);
            size = 2u;
        } else if field == 30u {
            gap = (code >> 8u) & 0xffffu;
            size = 3u;
        } else if field == 31u {
            gap = bytes_at((*leaf).codes + 1u);
            size = 5u;
        }
        (*leaf).next += gap;
        (*leaf).run = (code & 7u) + 1u;
        (*leaf).codes += size;
    }
    return id;
}
