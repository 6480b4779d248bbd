"""Deep reinforcement learning of trials: soft actor-critic (Haarnoja et al. 2018) of Stable-Baselines3."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from experiments.reinforcement.trials import Policy, Trials, replaying, reward

RESIDUAL, REACH = 0.05, 0.2
"""rad beside the next sub-goal, and from where a joint is, that an action of 1 asks for."""
NET, BATCH, EPOCHS, LAMBDA, RATE, CLIP, DISCOUNT, TIMID = (64, 64), 400, 10, 0.8, 1e-3, 0.2, 0.8, -1.0
"""What an action does to a servo is felt within a few ticks; updates for every tick of all copies; trials before the
first of them; logarithm of the first residual actions' standard deviation."""


def told(trials: Trials, actions: Any, residual: bool) -> Any:
    """(B, J) joint angles for (B, J) actions in [-1, 1]."""
    return replaying(trials) + RESIDUAL * actions if residual else trials.angles + REACH * actions


def vectorised(trials: Trials, residual: bool) -> Any:
    """Trials as Stable-Baselines3 has environments: all copies' episodes begin and end together, the next at once."""
    from gymnasium.spaces import Box
    from stable_baselines3.common.vec_env import VecEnv

    class Vectorised(VecEnv):
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
    nets = {"net_arch": list(NET), "log_std_init": TIMID, "activation_fn": torch.nn.Tanh}
    how = {"n_steps": trials.steps, "batch_size": BATCH, "n_epochs": EPOCHS, "gamma": DISCOUNT, "gae_lambda": LAMBDA, "learning_rate": RATE, "clip_range": CLIP}
    learner = PPO("MlpPolicy", scaled, seed=seed, device="cpu", policy_kwargs=nets, **how)
    torch.nn.init.zeros_(learner.policy.action_net.weight)

    def policy(tried: Trials) -> Any:
        seen = scaled.normalize_obs(tried.observation().astype(np.float32))
        return told(tried, learner.predict(seen, deterministic=True)[0].astype(float), residual)

    yield policy
    while True:
        learner.learn(trials.steps * trials.body.copies, reset_num_timesteps=False, log_interval=10**9)
        yield policy
