import torch

from maulstick.rendering.threads import one_thread_for_networks, one_torch_thread, usual_torch_threads


def test_networks_get_torch_s_own_number_of_threads_and_one_where_that_is_asked() -> None:
    usual = torch.get_num_threads()
    with one_torch_thread():
        with usual_torch_threads():
            assert torch.get_num_threads() == usual
        with one_thread_for_networks(), usual_torch_threads():
            assert torch.get_num_threads() == 1
        with usual_torch_threads():
            assert torch.get_num_threads() == usual
    assert torch.get_num_threads() == usual
