import pickle

from maulstick.planning.features.network import LoadedOnce
from tests.support.planning.tiny_network import TinyNetwork


def test_a_network_is_loaded_at_the_first_call_and_once() -> None:
    loads: list[int] = []

    def load() -> TinyNetwork:
        loads.append(1)
        return TinyNetwork()

    network = LoadedOnce(load)
    assert not loads
    assert network() is network()
    assert loads == [1]


def test_it_is_sent_to_another_process_without_what_was_loaded() -> None:
    network = LoadedOnce(TinyNetwork)
    before = pickle.dumps(network)
    network()
    assert pickle.dumps(network) == before
    assert isinstance(pickle.loads(before)(), TinyNetwork)
