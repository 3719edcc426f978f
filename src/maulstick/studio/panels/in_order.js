// What a person does before the page is connected reaches the server in the order in which it was done. NiceGUI lets each
// event wait by a timer of its own, and of those whichever comes first goes first: a click before what was typed.
{
  const waiting = [];
  let socket, isConnected = false;
  Object.defineProperty(window, "socket", {
    get: () => socket,
    set: (made) => {
      socket = made;
      const emit = made.emit;
      made.emit = (...message) => {
        if (isConnected || message[0] !== "event") return emit.apply(made, message);
        waiting.push(message);
        return made;
      };
    },
  });
  Object.defineProperty(window, "did_handshake", {
    get: () => socket !== undefined, // so that events are sent once there is a socket, and wait above
    set: (done) => {
      isConnected = done;
      if (done) for (const message of waiting.splice(0)) socket.emit(...message);
    },
  });
  window.forgetWaiting = () => {
    waiting.length = 0;
    if (socket) socket.sendBuffer = socket.sendBuffer.filter(({ data: [name] }) => name !== "event");
  };
}
