// Goals by hand: a place on the ground and a heading, published to the selected robot as geometry_msgs/PoseStamped on /ROBOT/goal_pose.
import type {Client} from '../net/client';
import type {Aim, SceneView} from '../scene/scene';
import {goalMessage} from './layer_data';
import type {Layers} from './layers';
import type {Store} from './store';

const answer_ms = 3000;

export function goalTopic(robot: string): string {
  return `/${robot}/goal_pose`;
}

/** The robots of a world that can be sent somewhere: some program listens to their goals. */
export function robotsWithGoals(robots: readonly string[], subscribed: {has: (topic: string) => boolean}): string[] {
  return robots.filter((robot) => subscribed.has(goalTopic(robot)));
}

export class Goals {
  /** Whom the next goal is for. */
  robot: string | null = null;
  private stopGraph: (() => void) | null = null;
  private publisher: {robot: string; publish: (value: unknown) => boolean; close: () => void} | null = null;

  constructor(private readonly client: Client, private readonly store: Store, private readonly scene: SceneView, private readonly layers: Layers,
              private readonly tell: (text: string, kind?: 'info' | 'warning') => void) {
    store.onEpoch.on(() => scene.showGoal(null));
  }

  /** The tool is taken up. Resolves to null, or to why it is of no use, as a sentence. */
  async begin(): Promise<string | null> {
    this.end();
    const known = await this.listen();
    const robots = (this.store.world?.instances ?? []).filter((i) => i.robot).map((i) => i.name);
    const able = known ? robotsWithGoals(robots, this.client.graph.subscribedTopics) : robots;
    const selected = this.store.selected()?.instance;
    if (selected?.robot) this.robot = selected.name;
    else if (able.length === 1) this.robot = able[0] as string;
    else return able.length === 0 ? 'No robot of this run takes goals: no program listens to a topic goal_pose.' : 'Select the robot that shall go somewhere first.';
    return able.includes(this.robot) ? null : `${this.robot} takes no goals: none of its programs listens to ${goalTopic(this.robot)}.`;
  }

  /** The tool is put away; the flag stays. */
  end(): void {
    this.stopGraph?.();
    this.stopGraph = null;
    this.robot = null;
  }

  aim(aim: Aim): void {
    const robot = this.robot;
    if (aim.phase === 'cancel' || robot === null) {
      this.scene.showGoal(null);
      return;
    }
    const yaw_rad = aim.yaw_rad ?? this.usualYaw(robot, aim.at);
    if (aim.phase !== 'end') {
      this.scene.showGoal(aim.at, yaw_rad, aim.pointer);
      return;
    }
    this.scene.showGoal(aim.at, yaw_rad);
    const frame = this.layers.goalFrame(robot);
    const message = goalMessage(frame, this.layers.framePose(frame, robot), aim.at, yaw_rad, this.store.time_s);
    if (this.publisherOf(robot).publish(message)) this.tell(`${robot} is sent to ${aim.at[0].toFixed(2)}, ${aim.at[1].toFixed(2)} in ${frame}`);
    else this.tell('The goal could not be sent', 'warning');
  }

  /** Without a drag the robot arrives as it comes: from where it is. */
  private usualYaw(robot: string, at: readonly number[]): number {
    const from = this.scene.pose(robot)?.position ?? [0, 0, 0];
    return Math.atan2((at[1] ?? 0) - from[1], (at[0] ?? 0) - from[0]);
  }

  private publisherOf(robot: string): {publish: (value: unknown) => boolean} {
    if (this.publisher?.robot !== robot) {
      this.publisher?.close();
      this.publisher = {robot, ...this.client.publisher(goalTopic(robot), 'geometry_msgs/msg/PoseStamped')};
    }
    return this.publisher;
  }

  /** Asks who listens to what. False: this server does not say. */
  private listen(): Promise<boolean> {
    if (!this.client.info?.capabilities.includes('connectionGraph')) return Promise.resolve(false);
    return new Promise((resolve) => {
      let timer: ReturnType<typeof setTimeout> | undefined = undefined;
      // Kept while the tool is held. A page that shows the graph has it already, and then this is called at once.
      this.stopGraph = this.client.subscribeGraph((graph) => {
        if (graph.publishedTopics.size + graph.subscribedTopics.size === 0) return;
        clearTimeout(timer);
        resolve(true);
      });
      timer = setTimeout(() => resolve(false), answer_ms);
    });
  }
}
