// 8-byte nodes: layout/plain/layout.rs. Twin: twin/nodes.rs.

struct Leaf { first: u32, left: u32, upper: u32, narrow: bool, gap: u32 }

fn is_leaf(lower: u32) -> bool { return (lower & 3u) == 3u; }

fn node_lower(address: u32) -> u32 { return word(params.nodes + 2u * address); }

fn inner(address: u32, lower: u32) -> Inner {
    let upper = word(params.nodes + 2u * address + 1u);
    let left = lower >> 3u;
    var triangle = NONE;
    if (lower & 4u) != 0u { triangle = word(params.nodes + 2u * (left + 2u)); }
    return Inner(lower & 3u, bitcast<f32>(upper), left, left + 1u, triangle);
}

fn open_leaf(address: u32, lower: u32) -> Leaf {
    let upper = word(params.nodes + 2u * address + 1u);
    let narrow = (upper >> 30u) == 1u;
    let count = select(upper & 0x3fffffffu, (upper >> 16u) & 0x3fffu, narrow);
    return Leaf(lower >> 3u, count, upper << 16u, narrow, 0u);
}

fn next_id(leaf: ptr<function, Leaf>) -> u32 {
    let at = (*leaf).first;
    (*leaf).first = at + 1u;
    (*leaf).left -= 1u;
    if (*leaf).narrow {
        let pair = word(params.indices_2byte + (at >> 1u));
        return (*leaf).upper | ((pair >> ((at & 1u) * 16u)) & 0xffffu);
    }
    return word(params.indices_4byte + at);
}
