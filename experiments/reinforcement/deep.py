"""Deep reinforcement learning of trials: proximal policy optimisation (Schulman et al. 2017) of Stable-Baselines3.

Its soft actor-critic, with two updates a tick, takes some ten times as long to learn from as much experience.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from babbling.axes import FloatArray
from experiments.reinforcement.trials import Policy, Trials, replaying, reward

RESIDUAL = 0.05
"""rad beside the next sub-goal that an action of 1 asks for."""
DISCOUNT, TRACE, TIMID = 0.8, 0.8, {True: -1.0, False: -2.0}
"""What is told a servo is felt within a few ticks; logarithm of the first actions' deviation, by `residual`."""
HOW = {"n_epochs": 10, "gamma": DISCOUNT, "gae_lambda": TRACE, "learning_rate": 1e-3}
NET = (64, 64)


def told(trials: Trials, actions: FloatArray, residual: bool) -> FloatArray:
    """(B, J) joint angles for (B, J) actions in [-1, 1]: so far beside the next sub-goal; or the motor lines
    themselves. (To be told how far from here, as Eq. (1)'s actions have it, was worse for who begins with nothing:
    nothing then holds it up.)"""
    inner = trials.body.body
    return replaying(trials) + RESIDUAL * actions if residual else inner.commands(actions)


def vectorised(trials: Trials, residual: bool) -> Any:
    """Trials as Stable-Baselines3 has environments: all copies' episodes begin and end together, the next at once."""
    from gymnasium.spaces import Box
    from stable_baselines3.common.vec_env import VecEnv

    class Vectorised(VecEnv):
        render_mode = None

        def __init__(self) -> None:
            wide = Box(-np.inf, np.inf, trials.observation().shape[1:], np.float32)
            super().__init__(trials.body.copies, wide, Box(-1.0, 1.0, trials.goals.shape[1:], np.float32))

        def reset(self) -> Any:
            trials.reset()
            return trials.observation().astype(np.float32)

        def step_async(self, actions: Any) -> None:
            self.actions = actions

        def step_wait(self) -> Any:
            missed = trials.step(told(trials, np.asarray(self.actions, float), residual))
            felt, infos = trials.observation().astype(np.float32), [dict[str, Any]() for _ in range(self.num_envs)]
            if over := trials.over:
                infos = [{"terminal_observation": one} for one in felt]
                felt = self.reset()
            return felt, reward(missed).astype(np.float32), np.full(self.num_envs, over), infos

        def close(self) -> None:
            pass

        def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
            return [getattr(self, attr_name)] * self.num_envs

        def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
            raise AttributeError(attr_name)

        def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
            raise AttributeError(method_name)

        def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
            return [False] * self.num_envs

    return Vectorised()


def proximal(trials: Trials, seed: int, *, residual: bool) -> Iterator[Policy]:
    """Policies before and after every trial; `residual` ones begin as direct replay.

    Observations are brought to mean 0 and variance 1 as they come; of rewards, their scale.
    """
    import torch
    from stable_baselines3 import PPO
    from stable_baselines3.common.vec_env import VecNormalize

    torch.set_num_threads(1)
    scaled = VecNormalize(vectorised(trials, residual), gamma=DISCOUNT)
    nets = {"net_arch": list(NET), "log_std_init": TIMID[residual]}
    learner = PPO(
        "MlpPolicy",
        scaled,
        n_steps=trials.steps,
        batch_size=trials.steps,
        seed=seed,
        device="cpu",
        policy_kwargs=nets,
        **HOW,
    )
    torch.nn.init.zeros_(learner.policy.action_net.weight)

    def policy(tried: Trials) -> Any:
        seen = scaled.normalize_obs(tried.observation().astype(np.float32))
        return told(tried, learner.predict(seen, deterministic=True)[0].astype(float), residual)

    yield policy
    while True:
        learner.learn(trials.steps * trials.body.copies, reset_num_timesteps=False, log_interval=10**9)
        yield policy
