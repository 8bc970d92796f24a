from collections import Counter

from visuohaptic.studies.sampling import sample_objects


def keys(**counts):
    return sorted(f"{name}/{place:04d}" for name, count in counts.items() for place in range(count))


def classes(objects):
    return Counter(key.partition("/")[0] for key in objects)


def test_all_objects_are_taken_up_to_the_maximum():
    objects = keys(car=71, dog=71)
    assert sample_objects(objects, 142) == objects


def test_classes_keep_their_shares_and_objects_are_spread_over_each():
    objects = keys(car=600, dog=300, mug=100)
    chosen = sample_objects(objects, 100)
    assert classes(chosen) == {"car": 60, "dog": 30, "mug": 10}
    assert chosen == sorted(set(chosen))
    assert chosen[-10:] == [f"mug/{place:04d}" for place in range(0, 100, 10)]


def test_a_rare_class_keeps_two_objects_if_it_has_them():
    chosen = sample_objects(keys(car=1000, dog=3, mug=1), 20)
    assert classes(chosen) == {"car": 20, "dog": 2, "mug": 1}
