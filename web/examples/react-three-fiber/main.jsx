import { OrbitControls } from '@react-three/drei';
import { Canvas } from '@react-three/fiber';
import { StrictMode, Suspense } from 'react';
import { createRoot } from 'react-dom/client';
import { AgXToneMapping } from 'three';
import { Room } from './room.jsx';

createRoot(document.getElementById('root')).render(
    <StrictMode>
        <Canvas gl={{ toneMapping: AgXToneMapping }} camera={{ fov: 40, near: 0.01, far: 100 }}>
            <Suspense fallback={null}>
                <Room url="room.phat.glb" />
            </Suspense>
            <OrbitControls target={[0, 0.8, 0]} />
        </Canvas>
    </StrictMode>,
);
